// Nothing: what this target precompiles is what it is for.
