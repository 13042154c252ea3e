// No tests: the program of this file is there for its precompiled headers, which all test programs use.
