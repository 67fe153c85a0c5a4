// The reference of a command line in Markdown.
#ifndef LATVOX_MANUAL_MARKDOWN_H_
#define LATVOX_MANUAL_MARKDOWN_H_

#include <string>

#include "deploy/manual/command_facts.h"
#include "deploy/manual/man_page.h"

namespace latvox {

// Returns a page in Markdown: a section for each command, then `page.after`. Lines of text have at most 120 characters.
// A section has usage, options by group and examples. --help stands only at the top.
std::string ToMarkdown(const CommandFacts& program, const ManPage& page);

}  // namespace latvox

#endif  // LATVOX_MANUAL_MARKDOWN_H_
