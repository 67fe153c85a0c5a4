// What the kernel counts of this process.
#ifndef LATVOX_SERVER_PROCESS_FACTS_H_
#define LATVOX_SERVER_PROCESS_FACTS_H_

namespace latvox {

// Each is 0 if the kernel does not tell.
double ResidentMemoryBytes();
double CpuSeconds();  // user and system, all threads
double OpenFiles();
double MaxOpenFiles();
double Threads();
double StartTimeSeconds();  // since 1970-01-01 UTC

}  // namespace latvox

#endif  // LATVOX_SERVER_PROCESS_FACTS_H_
