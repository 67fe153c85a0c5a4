// Settings of a configuration file in TOML.
#ifndef LATVOX_MANUAL_TOML_FILE_H_
#define LATVOX_MANUAL_TOML_FILE_H_

#include <cstdint>
#include <string>
#include <vector>

namespace latvox {

// One line KEY = VALUE.
struct FileSetting {
  enum class Kind { kTruth, kInteger, kNumber, kText, kTexts, kOther };

  std::string key;
  uint32_t line = 0;
  Kind kind = Kind::kOther;
  std::string kind_name;           // for people: "a boolean"
  std::vector<std::string> words;  // the value as words of a command line; empty for kOther
};

// The file may have at most this size.
inline constexpr uint64_t kMaxTomlBytes = uint64_t{1} << 20;

// Returns the settings in the order of their lines. Throws UsageError, with the path and the line: the file cannot be
// read, is too large or is no TOML.
std::vector<FileSetting> ReadTomlFile(const std::string& path);

}  // namespace latvox

#endif  // LATVOX_MANUAL_TOML_FILE_H_
