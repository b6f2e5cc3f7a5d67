#include <algorithm>
#include <cmath>
#include <cstdio>
#include <list>
#include <sstream>
#include <string_view>

#include <CLI/CLI.hpp>

#include <knurl/commandline/command.hpp>
#include <knurl/commandline/program.hpp>
#include <knurl/words/nearest.hpp>

namespace knurl::commandline {

namespace {

template <class T>
struct IsFloating : std::is_floating_point<T> {};
template <class T>
struct IsFloating<std::optional<T>> : std::is_floating_point<T> {};
template <class T>
struct IsInteger : std::is_integral<T> {};
template <class T>
struct IsInteger<std::optional<T>> : std::is_integral<T> {};

/// CLI11's range checks accept text that is no number.
std::string require_number(const std::string& text) {
    double value = 0;
    const bool none = CLI::detail::lexical_cast(text, value) && std::isnan(value);
    return none ? text + " is no number" : std::string();
}

std::string in_text(double number) {
    std::ostringstream text;
    text.precision(15);
    text << number;
    return text.str();
}

CLI::Validator within_range(double low, double high, bool whole) {
    const std::string range = in_text(low) + " to " + in_text(high);
    const auto problem = [=](const std::string& text) {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high &&
            (!whole || value == std::floor(value)))
            return std::string();
        return "'" + text + "'; give " + (whole ? "a whole number, " : "") + range;
    };
    return {problem, (whole ? "INT in [" : "FLOAT in [") + in_text(low) + " - " + in_text(high) + "]"};
}

CLI::Option* add_to(CLI::App& app, const std::string& name, const Target::Variable& to,
                    const std::string& help) {
    return std::visit(
        [&](auto* variable) {
            using T = std::remove_pointer_t<decltype(variable)>;
            CLI::Option* option = nullptr;
            if constexpr (std::is_same_v<T, std::filesystem::path>)
                option = app.add_option_function<std::string>(
                    name, [variable](const std::string& text) { *variable = text; }, help);
            else
                option = app.add_option(name, *variable, help);
            if constexpr (std::is_same_v<T, std::vector<std::string>>)
                option->expected(1)
                    ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
                    ->allow_extra_args(false);
            if constexpr (IsFloating<T>::value) option->check(require_number);
            return option;
        },
        to);
}

}  // namespace

struct Option::Impl {
    CLI::App* app;
    CLI::Option* option;
    Target::Variable to;
    std::string help;
    CLI::Option* former = nullptr;
};

Option::Option(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Option::~Option() = default;

Option& Option::required() {
    impl_->option->required();
    return *this;
}

Option& Option::type_name(const std::string& name) {
    impl_->option->type_name(name);
    return *this;
}

Option& Option::shows_default() {
    impl_->option->capture_default_str();
    return *this;
}

Option& Option::within(double low, double high) {
    const bool whole =
        std::visit([](auto* to) { return IsInteger<std::remove_pointer_t<decltype(to)>>::value; }, impl_->to);
    impl_->option->check(within_range(low, high, whole));
    return *this;
}

Option& Option::positive() {
    impl_->option->check(CLI::PositiveNumber);
    return *this;
}

Option& Option::not_negative() {
    impl_->option->check(CLI::NonNegativeNumber);
    return *this;
}

Option& Option::one_of(const std::vector<std::string>& words) {
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
    impl_->option->check([words, all](const std::string& text) {
        if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
        return "'" + text + "'; " + words::did_you_mean(text, words, "it is one of " + all);
    });
    impl_->option->type_name("{" + all + "}");
    return *this;
}

Option& Option::checked(const std::function<void(const std::string&)>& check) {
    const auto problem = [check](const std::string& text) {
        try {
            check(text);
        } catch (const std::exception& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (CLI::Option* option : {impl_->option, impl_->former})
        if (option != nullptr) option->check(problem);
    return *this;
}

Option& Option::separated_by(char separator) {
    impl_->option->delimiter(separator);
    return *this;
}

Option& Option::value_may_be_missing() {
    impl_->option->expected(0, 1);
    return *this;
}

Option& Option::excludes(const std::vector<std::string>& names) {
    for (const std::string& name : names) impl_->option->excludes(impl_->app->get_option(name));
    return *this;
}

Option& Option::formerly(const std::string& name) {
    impl_->former = add_to(*impl_->app, name, impl_->to, impl_->help);
    if (name.starts_with('-')) impl_->former->group("");
    return *this;
}

bool Option::given_twice() const {
    return impl_->option->count() > 0 && impl_->former != nullptr && impl_->former->count() > 0;
}

std::string Option::name() const {
    return impl_->option->get_name();
}

bool Option::given() const {
    return impl_->option->count() > 0 || (impl_->former != nullptr && impl_->former->count() > 0);
}

struct Command::Impl {
    std::unique_ptr<CLI::App> own;  // of the program; its verbs are stored in it
    CLI::App* app = nullptr;
    bool requires_verb = false;
    std::list<Option> options;
    std::list<std::unique_ptr<Command>> verbs;
    std::function<int()> work;
    std::vector<std::string>* behind_dashes = nullptr;

    /// Of the verb that the words from `at` on begin with.
    std::vector<std::string>* wants_words(int argc, const char* const* argv, int at = 1) const {
        for (const auto& verb : verbs)
            if (at < argc && verb->impl_->app->get_name() == argv[at])
                return verb->impl_->wants_words(argc, argv, at + 1);
        return behind_dashes;
    }
    /// The innermost chosen verb, or this command.
    const Impl& chosen() const {
        for (const auto& verb : verbs)
            if (verb->impl_->app->parsed()) return verb->impl_->chosen();
        return *this;
    }
    std::string path() const {
        const CLI::App* parent = app->get_parent();
        std::string text = app->get_name();
        for (; parent != nullptr; parent = parent->get_parent()) text = parent->get_name() + " " + text;
        return text;
    }
    std::string see_help() const { return "; see " + path() + " --help"; }

    /// Refuses a word in the place of a verb that is no verb.
    void require_verbs(int argc, const char* const* argv, int at = 1) const {
        if (verbs.empty() || (at < argc && argv[at][0] == '-')) return;
        if (at >= argc) {
            if (!requires_verb) return;
            std::string all;
            for (const auto& verb : verbs) all += (all.empty() ? "" : ", ") + verb->impl_->app->get_name();
            throw UsageError("which of " + all + "?" + see_help());
        }
        std::vector<std::string> names;
        for (const auto& verb : verbs) {
            names.push_back(verb->impl_->app->get_name());
            if (names.back() == argv[at]) return verb->impl_->require_verbs(argc, argv, at + 1);
        }
        throw UsageError(std::string("there is no verb '") + argv[at] + "'" + words::meant(argv[at], names) +
                         see_help());
    }
    /// Refuses an option together with its former name.
    void require_once() const {
        for (const Option& option : options)
            if (option.given_twice())
                throw UsageError("an option is given twice: " + option.name() +
                                 " is given under both its names" + see_help());
    }
    /// A misspelt option is reported first, whatever else is missing because of it.
    std::string unknown_option() const {
        for (const std::string& word : app->remaining()) {
            if (word.size() < 2 || word[0] != '-' || word == "--") continue;
            const std::string name = word.substr(0, word.find('='));
            std::vector<std::string> names{"--help"};
            for (const CLI::Option* option : app->get_options())
                if (!option->get_group().empty())
                    for (const std::string& known : option->get_lnames()) names.push_back("--" + known);
            return "there is no option '" + name + "'" + words::meant(name, names);
        }
        return {};
    }
};

Command::Command(const std::string& name, const std::string& purpose) : impl_(std::make_unique<Impl>()) {
    impl_->own = std::make_unique<CLI::App>(purpose, name);
    impl_->app = impl_->own.get();
    impl_->app->set_version_flag("--version", name + " " + KNURL_VERSION);
}

Command::Command(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Command::~Command() = default;

Option& Command::option(const std::string& name, const Target& to, const std::string& help) {
    CLI::Option* option = add_to(*impl_->app, name, to.variable(), help);
    return impl_->options.emplace_back(
        std::unique_ptr<Option::Impl>(new Option::Impl{impl_->app, option, to.variable(), help}));
}

Option& Command::flag(const std::string& name, bool& to, const std::string& help) {
    return impl_->options.emplace_back(std::unique_ptr<Option::Impl>(
        new Option::Impl{impl_->app, impl_->app->add_flag(name, to, help), {}, {}}));
}

Option& Command::servo(std::string& to, const std::string& help) {
    return option("--servo", to, help).type_name("NAME").formerly("--connect");
}

Command& Command::words_behind_dashes(std::vector<std::string>& to) {
    impl_->behind_dashes = &to;
    return *this;
}

Command& Command::verb(const std::string& name, const std::string& purpose) {
    auto impl = std::make_unique<Impl>();
    impl->app = impl_->app->add_subcommand(name, purpose);
    impl_->app->require_subcommand(impl_->requires_verb ? 1 : 0, 1);
    return *impl_->verbs.emplace_back(std::unique_ptr<Command>(new Command(std::move(impl))));
}

Command& Command::requires_verb() {
    impl_->requires_verb = true;
    return *this;
}

Command& Command::footer(const std::string& text) {
    impl_->app->footer(text);
    return *this;
}

Command& Command::footer(std::function<std::string()> text) {
    impl_->app->footer(std::move(text));
    return *this;
}

Command& Command::action(std::function<int()> work) {
    impl_->work = std::move(work);
    return *this;
}

Command::Answer Command::parse(int argc, const char* const* argv) {
    impl_->require_verbs(argc, argv);
    std::vector<std::string>* const words = impl_->wants_words(argc, argv);
    int end = argc;
    if (words != nullptr) end = static_cast<int>(std::find(argv, argv + argc, std::string_view("--")) - argv);
    try {
        impl_->app->parse(end, argv);
    } catch (const CLI::CallForVersion& version) {
        std::printf("%s\n", version.what());
        return Answer::nothing;
    } catch (const CLI::Success&) {
        print(impl_->app->help());
        return Answer::nothing;
    } catch (const CLI::ParseError& error) {
        const Impl& chosen = impl_->chosen();
        const std::string slip = chosen.unknown_option();
        throw UsageError((slip.empty() ? error.what() : slip) + chosen.see_help());
    }
    impl_->chosen().require_once();
    if (words == nullptr) return Answer::work;
    if (end + 1 < argc)
        words->assign(argv + end + 1, argv + argc);
    else
        throw UsageError("which program? It stands behind --: " + impl_->chosen().path() +
                         " -- PROGRAM [ARGUMENT ...]" + impl_->chosen().see_help());
    return Answer::work;
}

std::string Command::chosen_path() const {
    return impl_->chosen().path();
}

int Command::act() const {
    return impl_->chosen().work();
}

}  // namespace knurl::commandline
