# Writes a source file that defines latvox::kCommit. Each build runs it. A file that would stay the same keeps its time.
# The commit is what the cache variable LATVOX_COMMIT says, else git, else the file `commit`, which `git archive` fills.
#   cmake -D SOURCE=<the repository's root> -D OUTPUT=<file> -D LATVOX_COMMIT=<commit, or empty> -P commit.cmake
cmake_minimum_required(VERSION 3.25)
file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/commit archived LIMIT_COUNT 1)
set(commit unknown)
if(LATVOX_COMMIT)
  set(commit ${LATVOX_COMMIT})
elseif(EXISTS ${SOURCE}/.git) # a tarball may lie in a repository of somebody else
  # Root may build what somebody else has checked out; git refuses that otherwise.
  execute_process(COMMAND git -c safe.directory=* -C ${SOURCE} describe --always --abbrev=40 --exclude=* --dirty=-modified
                  OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit ${found})
  endif()
elseif(archived MATCHES "^[0-9a-f]+$")
  set(commit ${archived})
endif()
if(NOT commit MATCHES "^[A-Za-z0-9._-]+$")
  message(FATAL_ERROR "LATVOX_COMMIT is \"${commit}\". It is a commit of letters, digits, dots, dashes and underscores.")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT "#include \"deploy/manual/commit.h\"

const char* const latvox::kCommit = \"@commit@\";
")
