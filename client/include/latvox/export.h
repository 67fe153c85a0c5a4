// Marks what a shared library of the SDK shows. Everything else in it is hidden.
#ifndef LATVOX_LATVOX_EXPORT_H_
#define LATVOX_LATVOX_EXPORT_H_

// Stands before each function and after each `class` of the public headers that the library defines. Plain structs need
// none: programs compile them whole.
#define LATVOX_EXPORT __attribute__((visibility("default")))

// Stands after `class` where a nested one is defined in a source file: else it would be shown with the outer one.
#define LATVOX_HIDDEN __attribute__((visibility("hidden")))

#endif  // LATVOX_LATVOX_EXPORT_H_
