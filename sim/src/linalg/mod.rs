//! Block-tridiagonal kernels over a lane type.
