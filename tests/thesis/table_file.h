// A table that the page reads: a CSV file with a header line.
#ifndef LATVOX_TESTS_THESIS_TABLE_FILE_H_
#define LATVOX_TESTS_THESIS_TABLE_FILE_H_

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "absl/strings/str_format.h"

namespace latvox::thesis {

class TableFile {
 public:
  TableFile(const std::string& path, const char* columns) : file_(path) { file_ << columns << "\n"; }
  template <class... Args>
  void Add(const absl::FormatSpec<Args...>& format, const Args&... args) {
    file_ << absl::StrFormat(format, args...) << "\n";
  }
  // Ends the program if anything could not be written.
  void Close() {
    file_.close();
    if (file_) return;
    std::perror("thesis_reproduce: a table could not be written");
    std::exit(1);
  }

 private:
  std::ofstream file_;
};

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_TABLE_FILE_H_
