// Marks the symbols that a shared library of the SDK shows. All others are hidden.
#ifndef LATVOX_LATVOX_EXPORT_H_
#define LATVOX_LATVOX_EXPORT_H_

// For each function and each `class` of the public headers that the library defines. Plain structs need no mark,
// because programs compile them whole.
#define LATVOX_EXPORT __attribute__((visibility("default")))

// For a nested class that a source file defines; otherwise it would be shown with the outer class.
#define LATVOX_HIDDEN __attribute__((visibility("hidden")))

#endif  // LATVOX_LATVOX_EXPORT_H_
