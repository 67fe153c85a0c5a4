#include <atomic>
#include <cstdint>
#include <filesystem>
#include <future>
#include <string>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "client/tool/vdb/program_path.h"
#include "client/tool/vdb/vdb.h"
#include "deploy/process/exhaustion.h"

#ifdef LATVOX_VDB_MODULE
#include <dlfcn.h>
#endif

namespace latvox::client {
namespace {

using Loaded = absl::StatusOr<const Vdb*>;

#ifdef LATVOX_VDB_MODULE

namespace fs = std::filesystem;

absl::Status Missing(const fs::path& path, const std::string& why) {
  return absl::FailedPreconditionError(
      absl::StrCat(path.string(), ": ", why, "; this part of the package latvox reads and writes OpenVDB's files"));
}

// Returns the module's path: beside the program, as in a build folder, or where cmake --install puts it.
absl::StatusOr<fs::path> FindModule() {
  std::error_code error;
  const fs::path folder = fs::canonical(ProgramPath(), error).parent_path();
  const fs::path beside = folder / LATVOX_VDB_MODULE;
  if (fs::exists(beside, error)) return beside;
  const fs::path installed = (folder / LATVOX_VDB_FOLDER / LATVOX_VDB_MODULE).lexically_normal();
  if (fs::exists(installed, error)) return installed;
  return Missing(installed, "no such file");
}

// Returns the start of the library with the symbol of this name that this program uses.
const void* Owner(const char* name) {
  const void* const symbol = dlsym(RTLD_DEFAULT, name);
  Dl_info owner{};
  return symbol != nullptr && dladdr(symbol, &owner) != 0 ? owner.dli_fbase : nullptr;
}

// The loader looks for each of OpenVDB's 35,000 names in some 60 libraries of this program before OpenVDB's own, unless
// RTLD_DEEPBIND reverses that, in half the time. Then the module and its libraries use no symbol of the program, nor of
// a library that somebody preloads. So it must not be where these have an allocator or standard streams of their own:
// two of them would be in one process.
int BindDeep() {
  const void *const c = Owner("gnu_get_libc_version"), *const cxx = Owner("__cxa_throw");
  const bool one_allocator =
      Owner("malloc") == c && Owner("free") == c && Owner("_Znwm") == cxx && Owner("_ZdlPv") == cxx;
  const bool one_stream = Owner("_ZSt4cout") == cxx && Owner("_ZSt4cerr") == cxx && Owner("_ZSt4clog") == cxx;
  return one_allocator && one_stream ? RTLD_DEEPBIND : 0;
}

// Its libraries take 94 MB of addresses, stacks of threads included. They wait forever, or abort, without.
constexpr uint64_t kAddresses = uint64_t{128} << 20;

Loaded LoadModule() {
  const auto path = FindModule();
  if (!path.ok()) return path.status();
  if (absl::Status status = CheckAddresses(kAddresses); !status.ok()) return status;
  void* const module = dlopen(path->c_str(), RTLD_NOW | RTLD_LOCAL | BindDeep());
  if (module == nullptr) return Missing(*path, absl::StrCat("cannot be loaded (", dlerror(), ")"));
  const auto entry = reinterpret_cast<decltype(&latvox_vdb)>(dlsym(module, "latvox_vdb"));
  const Vdb* const vdb = entry != nullptr ? entry(LATVOX_VERSION) : nullptr;
  if (vdb == nullptr) return Missing(*path, absl::StrCat("is not of version ", LATVOX_VERSION));
  return vdb;
}

absl::Status CheckModule() { return FindModule().status(); }

#else  // it is part of the program

Loaded LoadModule() { return latvox_vdb(LATVOX_VERSION); }
absl::Status CheckModule() { return absl::OkStatus(); }

#endif

std::atomic<VdbState> g_state = VdbState::kAbsent;

// The first call decides where it loads: in a thread, or in the caller of get(), which also joins the thread. The
// result is never destroyed, because a process may end while the thread still works.
std::shared_future<Loaded> Loading(bool in_thread) {
  static const auto* const loading = [in_thread] {
    const auto start = [](std::launch where) {
      return new std::shared_future<Loaded>(std::async(where, LoadModule).share());
    };
    if (!in_thread) return start(std::launch::deferred);
    try {
      auto* const started = start(std::launch::async);
      g_state = VdbState::kLoading;
      return started;
    } catch (const std::system_error&) {  // there is no thread
      return start(std::launch::deferred);
    }
  }();
  return *loading;
}

}  // namespace

absl::Status Vdb::Prepare() {
  if (absl::Status status = CheckModule(); !status.ok()) return status;
  Loading(/*in_thread=*/true);
  return absl::OkStatus();
}

absl::StatusOr<const Vdb*> Vdb::Load() {
  auto vdb = Loading(/*in_thread=*/false).get();
  g_state = VdbState::kLoaded;
  return vdb;
}

VdbState Vdb::State() { return g_state; }

}  // namespace latvox::client
