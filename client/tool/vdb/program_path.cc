#include "client/tool/vdb/program_path.h"

namespace latvox::client {
namespace {

std::string& StoredPath() {
  static auto* const path = new std::string("/proc/self/exe");
  return *path;
}

}  // namespace

const std::string& ProgramPath() { return StoredPath(); }

void SetProgramPath(const std::string& path) { StoredPath() = path; }

}  // namespace latvox::client
