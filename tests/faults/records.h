// What became of each call, as lines of JSON in one file that many processes append to.
#ifndef LATVOX_TESTS_FAULTS_RECORDS_H_
#define LATVOX_TESTS_FAULTS_RECORDS_H_

#include <string>

namespace latvox::faults {

struct Record {
  int client = 0;
  int life = 0;  // of the client's process: it is another one after the client has killed itself
  int call = 0;  // within this life; the tries of one call have the same number
  std::string role, job;
  bool accepted = false;  // Accepted came
  // done      the right voxels came
  // refused   an overload answer, complete: with a delay after which to try again; and nothing had been accepted
  // cut       the same, and the load ends before the delay does
  // stopped   it was cancelled, or its deadline passed, as intended
  // rejected  a hostile call got the error it deserves
  // vanished  the process ends now, without a word
  // wrong     anything else
  std::string outcome;
  std::string detail;  // for people
  double ms = 0;       // of the call, from its first byte to its last
  int resumed = 0;     // times that the stream broke and another one went on
  double wait_ms = 0;  // from the first try, refusals and delays included
};

// Appends to a file. Each line is one write, so that those of other processes are not torn, nor lost if one is killed.
class Records {
 public:
  // Ends the program if the file cannot be opened.
  explicit Records(const std::string& path);
  void Write(const Record& record) const;

 private:
  int file_;
};

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_RECORDS_H_
