#pragma once
// Folders that tests write to, and what lies in them.

#include <sqlite3.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace wade::crowd::testing {

class TemporaryFolder {
 public:
    TemporaryFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "wade-test-XXXXXX").string();
        if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
        path = name;
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::filesystem::path path;
};

inline std::string content_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

// Name and content of each file in a folder.
inline std::map<std::string, std::string> files_in(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files[entry.path().filename().string()] = content_of(entry.path());
    }
    return files;
}

// Runs in a process of its own that ends without a goodbye; returns whether it came to its end.
template <typename Work>
bool in_killed_process(Work&& work) {
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        try {
            work();
            ::_exit(0);
        } catch (...) {
            ::_exit(1);
        }
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

// Another program's view of a database.
class Reader {
 public:
    explicit Reader(const std::filesystem::path& file, int flags = SQLITE_OPEN_READONLY) {
        REQUIRE(sqlite3_open_v2(file.c_str(), &handle, flags, nullptr) == SQLITE_OK);
    }
    ~Reader() {
        sqlite3_finalize(statement);
        sqlite3_close(handle);
    }
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;

    // All rows of a query, columns separated by '|', rows by a line end.
    std::string query(const std::string& sql) {
        std::string rows;
        const auto row = [](void* out, int columns, char** values, char**) {
            auto& text = *static_cast<std::string*>(out);
            for (int i = 0; i < columns; ++i) {
                if (i > 0) text += '|';
                text.append(values[i] == nullptr ? "" : values[i]);
            }
            text += '\n';
            return 0;
        };
        char* error = nullptr;
        const int code = sqlite3_exec(handle, sql.c_str(), row, &rows, &error);
        INFO((error == nullptr ? "" : error));
        CHECK(code == SQLITE_OK);
        sqlite3_free(error);
        return rows;
    }

    // Begins a query and leaves it at its first row.
    void leave_open(const std::string& sql) {
        REQUIRE(sqlite3_prepare_v2(handle, sql.c_str(), -1, &statement, nullptr) == SQLITE_OK);
        REQUIRE(sqlite3_step(statement) == SQLITE_ROW);
    }

    sqlite3* handle = nullptr;
    sqlite3_stmt* statement = nullptr;
};

inline std::string query(const std::filesystem::path& file, const std::string& sql) {
    return Reader(file).query(sql);
}

}  // namespace wade::crowd::testing
