#pragma once
// A maker's library, loaded. Its functions are declared by us, from what the maker's documentation says of them.

#include <string>

namespace knurl::device {

class Library {
  public:
    /// Throws std::runtime_error: what is missing, the command that mends it.
    explicit Library(const std::string& path);
    // Never unloaded: threads that the library has started may still run in it.
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;

    /// Throws std::runtime_error if there is no such function: it is another version, or another library.
    template <class Function>
    void need(const char* name, Function*& function) const {
        function = reinterpret_cast<Function*>(find(name));
        if (function == nullptr) missing(name);
    }
    /// nullptr if there is none.
    template <class Function>
    void want(const char* name, Function*& function) const {
        function = reinterpret_cast<Function*>(find(name));
    }
    const std::string& path() const { return path_; }

  private:
    void* find(const char* name) const;
    [[noreturn]] void missing(const char* name) const;

    std::string path_;
    void* handle_;
};

}  // namespace knurl::device
