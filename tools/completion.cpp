// SPDX-License-Identifier: Apache-2.0
// gcdt completion: what a shell needs to complete the command, and its man page, made of the command's own tables.
#include "completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace gcdt::command {

namespace {

enum class Value { none, choice, file, other };

/// An option or an argument as shells see it.
struct Shown {
  std::vector<std::string> names;    ///< with dashes
  std::string about;                 ///< its first sentence
  std::string type;                  ///< of its value, as the help has it
  std::vector<std::string> choices;  ///< of its value, if those are known
  Value value = Value::none;
};

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

/// Ends before what is in parentheses, where the sentence ends within them.
std::string first_sentence(const std::string& text) {
  std::string sentence = text.substr(0, std::min(text.find_first_of(";\n"), text.find(": ")));
  std::replace(sentence.begin(), sentence.end(), '[', '(');  // zsh has brackets around it
  std::replace(sentence.begin(), sentence.end(), ']', ')');
  while (std::count(sentence.begin(), sentence.end(), '(') > std::count(sentence.begin(), sentence.end(), ')'))
    sentence.erase(sentence.rfind(" ("));
  return sentence;
}

/// In single quotes, in which `quote` stands for one.
std::string quoted(const std::string& text, const char* quote) {
  std::string all = "'";
  for (const char c : text) all += c == '\'' ? quote : std::string(1, c);
  return all + "'";
}
constexpr const char *quote_of_zsh = "'\\''", *quote_of_fish = "\\'";

Value value_of(const std::string& type, Shown& shown) {
  static const std::vector<std::string> files = {"OUTPUT", "FILE",  "FILE.json", "PAGE.html", "OUTPUT.poly",
                                                 "DIR",    "INPUT", "POINTS",    "DIRECTORY"};
  if (type.find('|') != std::string::npos) shown.choices = split(type, '|');
  if (type == "SHELL") shown.choices = {"bash", "zsh", "fish", "man"};
  if (type.substr(0, 4) == "SPEC") shown.choices = {"auto", "cpu", "gpu"};
  if (type == "SPEC,...") shown.choices.emplace_back("all");
  if (!shown.choices.empty()) return Value::choice;
  return std::find(files.begin(), files.end(), type) != files.end() ? Value::file : Value::other;
}

std::vector<Shown> options_of(const CLI::App& app) {
  std::vector<Shown> all;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) continue;
    Shown shown;
    for (const std::string& name : option->get_snames()) shown.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) shown.names.push_back("--" + name);
    shown.about = first_sentence(option->get_description());
    shown.type = option->get_type_name();
    if (option->get_items_expected_max() > 0) shown.value = value_of(shown.type, shown);
    all.push_back(shown);
  }
  return all;
}

/// What stands without an option's name: files, or one of some words.
Shown argument_of(const CLI::App& command) {
  Shown shown;
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) shown.value = value_of(option->get_name(true), shown);
  return shown;
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  std::vector<const CLI::App*> all;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) all.push_back(command);
  return all;
}

std::string joined(const std::vector<std::string>& words, const char* between) {
  std::string all;
  for (const std::string& word : words) all += (all.empty() ? "" : between) + word;
  return all;
}

std::string names_of(const CLI::App& app) {
  std::string all;
  for (const Shown& option : options_of(app)) all += (all.empty() ? "" : " ") + joined(option.names, " ");
  return all;
}

std::string bash(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    const Shown argument = argument_of(*command);
    const std::string words = joined(argument.choices, " ") + (argument.choices.empty() ? "" : " ");
    cases += fmt::format("    {})\n      words='{}{}'{}\n      case $before in\n", command->get_name(), words,
                         names_of(*command), argument.value == Value::file ? "" : " offers=words");
    for (const Shown& option : options_of(*command)) {
      if (option.value == Value::none) continue;
      cases += fmt::format("        {}) {} ;;\n", joined(option.names, " | "),
                           option.value == Value::file
                               ? "offers=files"
                               : fmt::format("offers=words words='{}'", joined(option.choices, " ")));
    }
    cases += "      esac ;;\n";
  }
  return fmt::format(R"(# gcdt(1) completion for bash
_gcdt() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words='' offers=''
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{} {}' -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  if [[ $offers == words || (! $offers && $word == -*) ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    compopt -o filenames
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -F _gcdt gcdt
)",
                     commands, names_of(app), cases);
}

/// What zsh offers for a value; a blank: nothing, but its name is shown.
std::string action(const Shown& shown) {
  return shown.value == Value::choice ? "(" + joined(shown.choices, " ") + ")"
         : shown.value == Value::file ? "_files"
                                      : " ";
}

std::string zsh(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += fmt::format(
        "    {}\n", quoted(command->get_name() + ":" + first_sentence(command->get_description()), quote_of_zsh));
    cases += fmt::format("    {}) _arguments", command->get_name());
    for (const Shown& option : options_of(*command))
      for (const std::string& name : option.names) {
        const std::string value = option.value == Value::none ? "" : fmt::format(":{}:{}", option.type, action(option));
        cases += " \\\n      " + quoted(fmt::format("*{}[{}]{}", name, option.about, value), quote_of_zsh);
      }
    if (const Shown argument = argument_of(*command); argument.value != Value::none)
      cases += fmt::format(" \\\n      '*:{}:{}'", argument.value == Value::file ? "file" : "what", action(argument));
    cases += " ;;\n";
  }
  return fmt::format(R"(#compdef gcdt
# gcdt(1) completion for zsh
local -a commands=(
{})
if ((CURRENT == 2)); then
  _describe command commands
else
  local command=${{words[2]}}
  shift words
  ((CURRENT--))
  case $command in
{}  esac
fi
)",
                     commands, cases);
}

std::string fish(const CLI::App& app) {
  std::string text = "# gcdt(1) completion for fish\n";
  for (const CLI::App* command : commands_of(app))
    text += fmt::format("complete -c gcdt -n __fish_use_subcommand -f -a {} -d {}\n", command->get_name(),
                        quoted(first_sentence(command->get_description()), quote_of_fish));
  for (const CLI::App* command : commands_of(app)) {
    const std::string begin = fmt::format("complete -c gcdt -n '__fish_seen_subcommand_from {}'", command->get_name());
    const Shown argument = argument_of(*command);
    if (argument.value == Value::none) text += begin + " -f\n";
    if (argument.value == Value::choice) text += fmt::format("{} -f -a '{}'\n", begin, joined(argument.choices, " "));
    for (const Shown& option : options_of(*command)) {
      text += begin;
      for (const std::string& name : option.names)
        text += name.size() == 2 ? fmt::format(" -s {}", name.substr(1)) : fmt::format(" -l {}", name.substr(2));
      if (option.value != Value::none) text += option.value == Value::file ? " -r -F" : " -x";
      if (option.value == Value::choice) text += fmt::format(" -a '{}'", joined(option.choices, " "));
      text += fmt::format(" -d {}\n", quoted(option.about, quote_of_fish));
    }
  }
  return text;
}

/// Text for troff: nothing in it is a request or an escape.
std::string troff(const std::string& text) {
  std::string all;
  bool begin = true;
  for (const char c : text) {
    if (begin && (c == '.' || c == '\'')) all += "\\&";
    all += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
    begin = c == '\n';
  }
  return all;
}

std::string man(const CLI::App& app, const std::string& version) {
  std::string text = fmt::format(".TH GCDT 1 \"\" \"gcdt {}\" \"User commands\"\n", version);
  text += ".SH NAME\ngcdt \\- " + troff(app.get_description()) + "\n.SH SYNOPSIS\n";
  for (const CLI::App* command : commands_of(app)) {
    text += fmt::format(".B gcdt {}\n", troff(command->get_name()));
    text += "[\\fIoption\\fR]...";
    for (const CLI::Option* option : command->get_options())
      if (option->get_positional()) text += fmt::format(" \\fI{}\\fR", troff(option->get_name(true)));
    text += "\n.br\n";
  }
  for (const CLI::App* command : commands_of(app)) {
    text += fmt::format(".SH {}\n{}.\n", troff(command->get_name()), troff(command->get_description()));
    for (const CLI::Option* option : command->get_options())
      if (option->get_positional())
        text += fmt::format(".TP\n.I {}\n{}.\n", troff(option->get_name(true)), troff(option->get_description()));
    for (const Shown& option : options_of(*command)) {
      const CLI::Option* own = command->get_option(option.names.back());
      text += fmt::format(".TP\n.B {}{}\n{}.\n", troff(joined(option.names, ", ")),
                          option.value != Value::none ? fmt::format(" \\fI{}\\fR", troff(own->get_type_name())) : "",
                          troff(own->get_description()));
    }
    const std::string footer = command->get_footer();
    for (const std::string& line : split(footer, '\n')) text += line.empty() ? ".PP\n" : troff(line) + "\n";
  }
  return text + ".SH ENVIRONMENT\n.TP\n.B GCDT_DEVICE\nThe device of all calls, as \\-\\-device says it.\n";
}

}  // namespace

std::string completion(const CLI::App& app, const std::string& what, const std::string& version) {
  return what == "bash" ? bash(app) : what == "zsh" ? zsh(app) : what == "fish" ? fish(app) : man(app, version);
}

}  // namespace gcdt::command
