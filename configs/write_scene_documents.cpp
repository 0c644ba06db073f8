// write_scene_documents ROOT: writes what scene_documents.hpp makes of the keys into the project at ROOT.

#include <filesystem>
#include <fstream>
#include <iostream>

#include "configs/scene/scene_documents.hpp"

int main(int argc, char** argv) {
    if (argc != 2) {
        std::cerr << "usage: write_scene_documents ROOT\n";
        return 2;
    }
    for (const wade::SceneDocument& document : wade::scene_documents()) {
        const std::filesystem::path file = std::filesystem::path(argv[1]) / document.file;
        std::ofstream out(file, std::ios::binary);
        if (!(out << document.text << std::flush)) {
            std::cerr << "write_scene_documents: cannot write " << file.string() << '\n';
            return 1;
        }
    }
    return 0;
}
