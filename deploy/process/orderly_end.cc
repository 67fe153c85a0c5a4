#include "deploy/process/orderly_end.h"

#include <signal.h>
#include <unistd.h>

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <new>

#include "absl/strings/string_view.h"
#include "deploy/process/exhaustion.h"

// Signal handlers call these functions, so they use neither the heap nor locks.
namespace latvox {
namespace {

constexpr int kSignals[] = {SIGABRT, SIGSEGV, SIGBUS};

void Put(absl::string_view text) {
  if (write(STDERR_FILENO, text.data(), text.size()) < 0) {
    // There is nowhere to report this error.
  }
}

void PutLimit() {
  const uint64_t limit = AddressLimit();
  if (limit == UINT64_MAX) return;
  char digits[32];
  const auto end = std::to_chars(digits, std::end(digits), limit / 1024).ptr;
  Put(" within the limit of ");
  Put({digits, static_cast<size_t>(end - digits)});
  Put(" KiB (ulimit -v)");
}

[[noreturn]] void EndForMemory() {
  Put(kOrderlyEnd.program);
  Put(": ");
  Put(kNoMemory);
  PutLimit();
  Put("\n");
  _exit(kOrderlyEnd.status);
}

void EndIfExhausted() {
  if (IsMemoryGone()) EndForMemory();
  if (!AreThreadsGone()) return;
  Put(kOrderlyEnd.program);
  Put(": ");
  Put(kNoThread);
  Put("\n");
  _exit(kOrderlyEnd.status);
}

[[noreturn]] void OnTerminate() {
  try {
    if (const std::exception_ptr error = std::current_exception()) std::rethrow_exception(error);
  } catch (const std::bad_alloc&) {
    EndForMemory();
  } catch (...) {
    EndIfExhausted();
  }
  std::abort();
}

// The signal arrives again, now with its usual effect.
void OnSignal(int signal_number) {
  EndIfExhausted();
  signal(signal_number, SIG_DFL);
  raise(signal_number);
}

alignas(16) char g_signal_stack[size_t{64} << 10];

// The first part runs before the initializers of the libraries, which may need memory or start threads, and end the
// process if they cannot.
[[maybe_unused]] void HandleFromTheStart(int, char**, char**) {
  std::set_terminate(OnTerminate);
  stack_t stack{};
  stack.ss_sp = g_signal_stack;
  stack.ss_size = sizeof(g_signal_stack);
  sigaltstack(&stack, nullptr);
  struct sigaction action {};
  action.sa_handler = OnSignal;
  action.sa_flags = SA_ONSTACK;
  for (const int signal_number : kSignals) sigaction(signal_number, &action, nullptr);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)  // sanitizers are not ready before main
__attribute__((section(".preinit_array"), used)) void (*const g_from_the_start)(int, char**,
                                                                                char**) = HandleFromTheStart;
#endif

}  // namespace

void EndOrderlyWhenExhausted() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
  HandleFromTheStart(0, nullptr, nullptr);
#endif
}

void EndAsUsual() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
  for (const int signal_number : kSignals) signal(signal_number, SIG_DFL);
  std::set_terminate(std::abort);
#endif
}

}  // namespace latvox
