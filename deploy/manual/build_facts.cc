#include "deploy/manual/build_facts.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace latvox {

std::string VersionPage(const std::string& program, const BuildFacts& facts) {
  const auto format = [](std::string* text, const BuildFacts::Library& library) {
    absl::StrAppend(text, library.name, " ", library.version);
  };
  return absl::StrCat(program, " " LATVOX_VERSION "\ncommit ", facts.commit, "\nbuilt with ",
                      absl::StrJoin(facts.libraries, ", ", format));
}

}  // namespace latvox
