//! The library as a program in C or C++ uses it: compiled, linked and run with the system's compiler.
#![cfg(target_os = "linux")]

mod common;
mod examples;
mod install;
mod page;
