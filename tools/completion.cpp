// SPDX-License-Identifier: Apache-2.0
// gcdt completion: what a shell needs to complete the command, and its man page, made of the command's own tables.
#include "completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace gcdt::command {

namespace {

/// An option as shells see it.
struct Shown {
  std::vector<std::string> names;    ///< with dashes
  std::string about;                 ///< its first sentence
  std::vector<std::string> choices;  ///< of its value, if those are known
  bool value = false;
};

std::string first_sentence(const std::string& text) {
  std::string sentence = text.substr(0, std::min(text.find_first_of(";\n"), text.find(": ")));
  for (char& c : sentence)
    if (c == '\'' || c == '"' || c == '[' || c == ']' || c == '`' || c == '$') c = ' ';
  return sentence;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, at);) parts.push_back(part);
  return parts;
}

std::vector<Shown> options_of(const CLI::App& app) {
  std::vector<Shown> all;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional()) continue;
    Shown shown;
    for (const std::string& name : option->get_snames()) shown.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) shown.names.push_back("--" + name);
    shown.about = first_sentence(option->get_description());
    shown.value = option->get_items_expected_max() > 0;
    const std::string type = option->get_type_name();
    if (type.find('|') != std::string::npos) shown.choices = split(type, '|');
    all.push_back(shown);
  }
  return all;
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
  std::string commands, cases, values;
  for (const CLI::App* command : commands_of(app)) {
    commands += (commands.empty() ? "" : " ") + command->get_name();
    cases += fmt::format("    {}) words='{}' ;;\n", command->get_name(), names_of(*command));
    for (const Shown& option : options_of(*command)) {
      const std::string line = fmt::format("    {}) COMPREPLY=($(compgen -W '{}' -- \"$word\")); return ;;\n",
                                           joined(option.names, " | "), joined(option.choices, " "));
      if (!option.choices.empty() && values.find(line) == std::string::npos) values += line;
    }
  }
  return fmt::format(R"(# gcdt(1) completion for bash
_gcdt() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words=''
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{} {}' -- "$word"))
    return
  fi
  case $before in
{}  esac
  case ${{COMP_WORDS[1]}} in
{}  esac
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    compopt -o filenames
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -F _gcdt gcdt
)",
                     commands, names_of(app), values, cases);
}

std::string zsh(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands += fmt::format("    '{}:{}'\n", command->get_name(), first_sentence(command->get_description()));
    cases += fmt::format("    {}) _arguments", command->get_name());
    for (const Shown& option : options_of(*command))
      for (const std::string& name : option.names) {
        const std::string value = !option.value            ? ""
                                  : option.choices.empty() ? ":value:_files"
                                                           : fmt::format(":value:({})", joined(option.choices, " "));
        cases += fmt::format(" \\\n      '*{}[{}]{}'", name, option.about, value);
      }
    cases += " \\\n      '*:file:_files' ;;\n";
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
    text += fmt::format("complete -c gcdt -n __fish_use_subcommand -f -a {} -d '{}'\n", command->get_name(),
                        first_sentence(command->get_description()));
  for (const CLI::App* command : commands_of(app))
    for (const Shown& option : options_of(*command)) {
      text += fmt::format("complete -c gcdt -n '__fish_seen_subcommand_from {}'", command->get_name());
      for (const std::string& name : option.names)
        text += name.size() == 2 ? fmt::format(" -s {}", name.substr(1)) : fmt::format(" -l {}", name.substr(2));
      if (!option.choices.empty())
        text += fmt::format(" -x -a '{}'", joined(option.choices, " "));
      else if (option.value)
        text += " -r";
      text += fmt::format(" -d '{}'\n", option.about);
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
                          option.value ? fmt::format(" \\fI{}\\fR", troff(own->get_type_name())) : "",
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
