// The values that options may have: on the command line, in the environment, and in a configuration file.
#ifndef LATVOX_MANUAL_OPTION_VALUES_H_
#define LATVOX_MANUAL_OPTION_VALUES_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "deploy/manual/command_facts.h"
#include "deploy/manual/option_row.h"
#include "deploy/manual/toml_file.h"

namespace latvox {

// Returns the largest value of a row of whole numbers, or 0 for other rows. A configuration file holds 63 bits.
uint64_t MostOf(const OptionRow& row);

// Returns the error of a word, or "".
std::string AboveMost(const std::string& word, uint64_t most);

// Replaces the word of a switch with "true" or "false". Returns the error, or "".
std::string ToTruth(std::string& word);

// Replaces a word in upper case, such as BCC, with the one of the list. Returns the error, or "".
std::string ToListed(const std::vector<std::string>& words, std::string& word);

// Returns the first error of a word, with its value and its limit.
WrongWord FindWrong(const OptionRow& row, const std::string& word);

// "268435456" as "256MiB", in the largest unit that divides it.
std::string SizeText(const std::string& bytes);

// Fills in the facts about the values, for help and pages: their name, such as N, words, range, default.
void DescribeValue(const OptionRow& row, OptionFacts& facts);

// Returns the value of an environment variable; "" if it has none, or if the name is empty.
std::string ValueOfVariable(const std::string& name);

// Whether the values of the row are texts, neither numbers nor switches.
bool IsText(const OptionRow& row);

// Rows by the keys of a configuration file.
using RowsOfKeys = std::map<std::string, const OptionRow*>;

// Returns the settings of a configuration file. Throws UsageError, with the path, the line, the key and the value: as
// ReadTomlFile does, or for a key that no row has, or for a value of the wrong type.
std::vector<FileSetting> ReadSettings(const std::string& path, const RowsOfKeys& rows);

}  // namespace latvox

#endif  // LATVOX_MANUAL_OPTION_VALUES_H_
