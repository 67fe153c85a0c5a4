// The end of a program that gets no more memory or threads.
#ifndef LATVOX_PROCESS_ORDERLY_END_H_
#define LATVOX_PROCESS_ORDERLY_END_H_

namespace latvox {

// Each program that calls EndOrderlyWhenExhausted defines this constant.
struct OrderlyEnd {
  const char* program;  // begins the line
  int status;           // exit status
};
extern const OrderlyEnd kOrderlyEnd;

// Ends this process with one line on standard error and the exit status in place of an abort, if memory or threads have
// run out. Libraries abort in that case, some of them even before main(). Other aborts stay what they are. If main()
// calls it, it works from the start of the process.
void EndOrderlyWhenExhausted();

// Undoes that, for a process that may not even ask.
void EndAsUsual();

}  // namespace latvox

#endif  // LATVOX_PROCESS_ORDERLY_END_H_
