// Man pages.
#ifndef LATVOX_MANUAL_MAN_PAGE_H_
#define LATVOX_MANUAL_MAN_PAGE_H_

#include <string>
#include <vector>

#include "deploy/manual/command_facts.h"

namespace latvox {

struct ManSection {
  std::string title, text;  // paragraphs separated by empty lines; lines that begin with two spaces are examples
};

struct ManPage {
  int section = 1;
  std::string version;
  std::vector<ManSection> before, after;  // the options
  std::vector<std::string> see_also;      // "latvoxd(8)"
};

// Returns a page in troff's man macros: name, synopsis, `before`, every option of the program and of each command,
// `after`.
std::string ToMan(const CommandFacts& program, const ManPage& page);

}  // namespace latvox

#endif  // LATVOX_MANUAL_MAN_PAGE_H_
