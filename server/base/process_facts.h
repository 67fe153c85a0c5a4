// Figures of the kernel about this process and its children.
#ifndef LATVOX_SERVER_BASE_PROCESS_FACTS_H_
#define LATVOX_SERVER_BASE_PROCESS_FACTS_H_

#include <sys/types.h>

namespace latvox {

// Each is 0 if the kernel does not give it.
double PrivateMemoryBytes(pid_t pid);  // resident memory of any process, without shared parts such as its program
double ResidentMemoryBytes();
double CpuSeconds();  // user and system, all threads
double OpenFiles();
double MaxOpenFiles();
double Threads();
double StartTimeSeconds();  // since 1970-01-01 UTC

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_PROCESS_FACTS_H_
