#pragma once

/// @file
/// The command line of a program: what it takes, said once for reading it and for --help. The parser behind
/// it is CLI11, whose header costs 18 s in every source that includes it: only command.cpp does.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace knurl::commandline {

/// The command line makes no sense: exit code 2.
class UsageError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Where the value of an option goes. A number that does not fit, or is none (nan), is refused. The variable
/// keeps its value where the option is not given. A vector takes one value, and one more each time that the
/// option is repeated.
class Target {
  public:
    /// The types of variables.
    using Variable =
        std::variant<std::string*, std::filesystem::path*, double*, int*, long*, unsigned*, std::uint16_t*,
                     std::uint64_t*, std::optional<std::string>*, std::optional<double>*, std::optional<int>*,
                     std::optional<std::uint64_t>*, std::vector<std::string>*>;
    /// The value goes into `variable`, which lives as long as the program's Command.
    template <class T>
    requires std::is_constructible_v<Variable, T*> Target(T& variable) : variable_(&variable) {}

    /// The variable.
    const Variable& variable() const { return variable_; }

  private:
    Variable variable_;
};

/// An option of a Command, which owns it.
class Option {
  public:
    /// It must be given.
    Option& required();
    /// What --help shows in place of TEXT, FLOAT, ...
    Option& type_name(const std::string& name);
    /// --help shows the value that the variable has now.
    Option& shows_default();
    /// The value must be from `low` to `high`.
    Option& within(double low, double high);
    /// The value must be above 0.
    Option& positive();
    /// The value must be 0 or more.
    Option& not_negative();
    /// The value must be one of these words.
    Option& one_of(const std::vector<std::string>& words);
    /// `check` throws what is wrong with a value: that is what is wrong with the command line.
    Option& checked(const std::function<void(const std::string&)>& check);
    /// Of a vector: one argument may hold several values, with this character between.
    Option& separated_by(char separator);
    /// "--json" alone is allowed beside "--json FILE": given() then, and the variable is empty.
    Option& value_may_be_missing();
    /// These are refused beside it. They must have been added before.
    Option& excludes(const std::vector<std::string>& names);
    /// A former name, which is taken too and not shown in --help. Without a dash: what stands for it without
    /// one, which is shown.
    Option& formerly(const std::string& name);

    /// After Command::parse: it was given.
    bool given() const;
    /// After Command::parse: it was given under this name and the former one.
    bool given_twice() const;
    /// Its name.
    std::string name() const;

    struct Impl;
    /// Made by Command.
    explicit Option(std::unique_ptr<Impl> impl);
    ~Option();

  private:
    std::unique_ptr<Impl> impl_;
};

/// A program or a verb: its options and what it does.
class Command {
  public:
    /// A program. It always has --help and --version.
    Command(const std::string& name, const std::string& purpose);
    ~Command();
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

    /// Adds an option ("--rate"), or what stands without one ("file"). `to` lives as long as the program's
    /// Command.
    Option& option(const std::string& name, const Target& to, const std::string& help);
    /// Adds a flag; `to` is true where it is given.
    Option& flag(const std::string& name, bool& to, const std::string& help);
    /// --servo, spelled alike by all programs: "default", "knurl:default", a socket's path, and where the
    /// help says so knurl://HOST:PORT.
    Option& servo(std::string& to, const std::string& help);
    /// All words behind "--" go into `to`, as they are: a program and its arguments. One must be there.
    Command& words_behind_dashes(std::vector<std::string>& to);
    /// Adds a verb: knurl VERB. Verbs may have verbs.
    Command& verb(const std::string& name, const std::string& purpose);
    /// One of the verbs must be given.
    Command& requires_verb();
    /// Text below the options in --help.
    Command& footer(const std::string& text);
    /// Text below the options in --help; the function is called only then.
    Command& footer(std::function<std::string()> text);
    /// What it does once the line has been read: returns the exit code, or throws what guarded() says.
    Command& action(std::function<int()> work);

    /// What is left to do after the line was read.
    enum class Answer {
        /// The program's work.
        work,
        /// Nothing: --help or --version has been answered.
        nothing,
    };
    /// Reads the line into the variables. Throws UsageError, one line: what was wrong, and which --help to
    /// read.
    Answer parse(int argc, const char* const* argv);
    /// After parse(): the verb that was chosen, "knurl record".
    std::string chosen_path() const;
    /// After parse(): runs the action of the verb that was chosen, or else of the program.
    int act() const;

  private:
    struct Impl;
    explicit Command(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace knurl::commandline
