# Writes PAGE to OUT with the links that are right where it is installed: all pages in one folder, with `examples` and
# `pictures` below it. HEADERS and PROTO lead from there to the headers and to the protocol. A link to anything else of
# the repository becomes plain text.
file(READ ${PAGE} text)
string(REGEX REPLACE "\\]\\(\\.\\./\\.\\./(client|server)/docs/" "](" text "${text}")
string(REPLACE "](../examples/" "](examples/" text "${text}")
string(REPLACE "](../include/" "](${HEADERS}/" text "${text}")
string(REPLACE "](../../proto/" "](${PROTO}/" text "${text}")
string(REGEX REPLACE "\\[([^]\n]*\n?[^]\n]*)\\]\\(\\.\\./\\.\\./(\\.github|deploy|tests)/[^)]*\\)" "\\1" text "${text}")
file(WRITE ${OUT} "${text}")
