//! Nothing: this package holds only the tests of the built page, in `tests/page/`.
