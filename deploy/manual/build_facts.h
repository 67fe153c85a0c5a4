// The commit and the libraries of a program, as --version and GetLimits tell them.
#ifndef LATVOX_MANUAL_BUILD_FACTS_H_
#define LATVOX_MANUAL_BUILD_FACTS_H_

#include <string>
#include <vector>

namespace latvox {

struct BuildFacts {
  struct Library {
    std::string name;
    std::string version;  // of its headers and build files; a shared library may be a later, compatible one
  };

  std::string commit;  // 40 hexadecimal digits, then "-modified" if files differed from that commit; or "unknown"
  std::vector<Library> libraries;  // in the order of their names
};

// Returns the facts of the program that calls it. latvox_add_build_facts in CMakeLists.txt makes its definition.
BuildFacts FactsOfThisBuild();

// The page of --version. Its first line is "PROGRAM VERSION", which scripts read.
std::string VersionPage(const std::string& program, const BuildFacts& facts);

}  // namespace latvox

#endif  // LATVOX_MANUAL_BUILD_FACTS_H_
