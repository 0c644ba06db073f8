// Prints the commit that the build names; a build with another greeting has other code.

#include <iostream>

#include "configs/program/version.hpp"

int main() {
    std::cout << GREETING << wade::git_hash() << '\n';
}
