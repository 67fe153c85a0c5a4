// Finds out whether a process gets no more memory or threads.
#ifndef LATVOX_PROCESS_EXHAUSTION_H_
#define LATVOX_PROCESS_EXHAUSTION_H_

#include <cstdint>
#include <exception>

#include "absl/status/status.h"

namespace latvox {

inline constexpr char kNoMemory[] = "not enough memory";
inline constexpr char kNoThread[] = "a thread cannot be started (ulimit -u, or the control group's pids.max)";

// Return whether the process gets no more addresses, or no more threads. Signal handlers may call them.
bool IsMemoryGone();
bool AreThreadsGone();

// Returns RESOURCE_EXHAUSTED for std::bad_alloc and for a thread that cannot be started, otherwise UNKNOWN.
absl::Status StatusOf(const std::exception& error);

// Returns the limit of the process's addresses in bytes (ulimit -v), or 2^64 - 1.
uint64_t AddressLimit();

// Makes a process with such a limit need fewer addresses. Otherwise the heap reserves 64 MiB for each thread. Call it
// before any thread starts.
void SpareAddresses();

// Gives the stacks of later threads at most this size if the process has such a limit, and returns their size.
uint64_t SpareStacks(uint64_t most);

// Returns RESOURCE_EXHAUSTED, with the limit, if the process cannot get so many addresses. Libraries wait forever, or
// abort, when their threads cannot start, so programs ask first.
absl::Status CheckAddresses(uint64_t bytes);

// Returns whether there are addresses for the threads that oneTBB starts for an algorithm. These wait forever, or
// abort, where their stacks find none.
bool HasAddressesForThreads();

// Returns RESOURCE_EXHAUSTED, with the count, if the process cannot start so many threads. Starts them, and waits for
// their end, because a limit counts all processes of a user, and does not tell how many there are.
absl::Status CheckThreads(int count);

}  // namespace latvox

#endif  // LATVOX_PROCESS_EXHAUSTION_H_
