// The commit, which commit.cmake writes into a source file of its own: a new commit compiles that file alone.
#ifndef LATVOX_MANUAL_COMMIT_H_
#define LATVOX_MANUAL_COMMIT_H_

namespace latvox {

extern const char* const kCommit;

}  // namespace latvox

#endif  // LATVOX_MANUAL_COMMIT_H_
