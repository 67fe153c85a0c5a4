// Man pages.
#ifndef LATVOX_MANUAL_MAN_PAGE_H_
#define LATVOX_MANUAL_MAN_PAGE_H_

#include <string>
#include <vector>

#include "deploy/manual/command_facts.h"

namespace latvox {

struct ManSection {
  std::string title, text;  // paragraphs, with an empty line between them; lines that begin with two spaces as they are
};

struct ManPage {
  int section = 1;
  std::string version;
  std::vector<ManSection> before, after;  // the options
  std::vector<std::string> see_also;      // "latvoxd(8)"
};

// A page in the language of troff's man macros: names, synopsis, `before`, every option of the program and of each of
// its commands, `after`.
std::string ToMan(const CommandFacts& program, const ManPage& page);

}  // namespace latvox

#endif  // LATVOX_MANUAL_MAN_PAGE_H_
