// Files for the client's tests.
#ifndef LATVOX_TESTS_UNIT_CLIENT_FILES_H_
#define LATVOX_TESTS_UNIT_CLIENT_FILES_H_

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "tests/unit/temporary_directory.h"

namespace latvox::client {

// A test with a fresh directory.
class FilesTest : public testing::Test {
 protected:
  std::string Path(const std::string& name) const { return directory_ / name; }

  std::string Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(Path(name), std::ios::binary) << bytes;
    return Path(name);
  }

  std::string Read(const std::string& name) const {
    std::ostringstream bytes;
    bytes << std::ifstream(Path(name), std::ios::binary).rdbuf();
    return bytes.str();
  }

  std::set<std::string> Names() const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(directory_.path())) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

 private:
  TemporaryDirectory directory_;
};

// Returns the bytes of a value in memory.
template <class T>
std::string Bytes(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_FILES_H_
