// The outcome of each call, as a line of JSON in one file. Many processes append to it.
#ifndef LATVOX_TESTS_FAULTS_RECORDS_H_
#define LATVOX_TESTS_FAULTS_RECORDS_H_

#include <string>

namespace latvox::faults {

struct Record {
  int client = 0;
  int life = 0;  // of the client's process; it changes after the client has killed itself
  int call = 0;  // within this life; the tries of one call share a number
  std::string role, job;
  bool accepted = false;  // Accepted arrived
  // done      the right voxels arrived
  // refused   a complete overload answer, with a retry delay; nothing had been accepted
  // cut       the same, and the load ends before the delay does
  // stopped   it was cancelled, or its deadline passed, as intended
  // rejected  a hostile call got the error that it deserves
  // vanished  the process ends now, without a word
  // wrong     anything else
  std::string outcome;
  std::string detail;  // for people
  double ms = 0;       // of the call, from first byte to last
  int resumed = 0;     // how often the stream broke and another one resumed it
  double wait_ms = 0;  // from the first try, refusals and delays included
};

// Appends to a file. Each line is one write, so lines of other processes stay whole, and survive a kill.
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
