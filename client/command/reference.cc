// ballpiston help: prints the pages of verbs, or writes them to files.
#include "client/command/reference.h"

#include <filesystem>
#include <set>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/command/suggestion.h"
#include "client/output/output_file.h"

namespace ballpiston::client {
namespace {

constexpr size_t kWidth = 80;

// The content of a page, the same in every format.
struct Section {
  std::string title;
  std::vector<Remark> entries = {};
};

struct Page {
  std::string name, summary, synopsis, description;
  std::vector<Section> sections = {};
  std::vector<std::string> examples = {};
  std::string more = "";  // the last line
};

std::string Described(const std::string& text, const Value& value, const std::string& variable) {
  std::string whole = text;
  if (!value.choices.empty()) {
    absl::StrAppend(&whole, ": ", absl::StrJoin(value.choices, " | "));
  }
  if (!variable.empty()) absl::StrAppend(&whole, " [", variable, "]");
  return whole;
}

std::string TermOf(const Flag& flag) {
  if (flag.name.empty()) return flag.variable;
  const std::string names = absl::StrReplaceAll(flag.name, {{",", ", "}});
  return flag.value.IsSwitch() ? names : absl::StrCat(names, " ", flag.value.name);
}

Section SectionOf(const FlagGroup& group) {
  Section section{.title = group.title};
  for (const Flag& flag : group.flags) {
    const std::string text = absl::StrCat(flag.text, flag.is_required ? "; required" : "");
    section.entries.push_back(
        {TermOf(flag), Described(text, flag.value, flag.name.empty() ? "" : flag.variable)});
  }
  return section;
}

std::string SynopsisOf(const Argument& argument) {
  const std::string word = absl::StrCat(argument.value.name, argument.IsMany() ? "..." : "");
  if (argument.IsRequired()) return absl::StrCat(" ", word);
  return absl::StrCat(argument.number == Argument::kRest ? " [-- " : " [", word, "]");
}

Page PageOf(const Verb& verb) {
  Page page{.name = absl::StrCat(kProgram, " ", verb.name),
            .summary = verb.summary,
            .synopsis = absl::StrCat(kProgram, " ", verb.name),
            .description = verb.description};
  Section arguments{.title = "Arguments"};
  std::string rest;
  for (const Argument& argument : verb.arguments) {
    (argument.number == Argument::kRest ? rest : page.synopsis) += SynopsisOf(argument);
    arguments.entries.push_back(
        {argument.value.name, Described(argument.text, argument.value, "")});
  }
  absl::StrAppend(&page.synopsis, " [FLAG...]", rest);
  if (!arguments.entries.empty()) page.sections.push_back(std::move(arguments));
  for (const FlagGroup* group : verb.groups) page.sections.push_back(SectionOf(*group));
  page.sections.back().entries.push_back({"-h, --help", "print this page"});
  for (const std::string& example : verb.examples) {
    page.examples.push_back(absl::StrCat(kProgram, " ", example));
  }
  return page;
}

// The text without what follows a semicolon.
std::string Gist(const std::string& text) { return text.substr(0, text.find(';')); }

Page ShortPageOf(const Verb& verb) {
  Page page = PageOf(verb);
  page.sections.resize(verb.arguments.empty() ? 0 : 1);
  std::vector<std::string> others;
  for (const FlagGroup* group : verb.groups) {
    FlagGroup everyday = {group->title, {}};
    for (Flag flag : group->flags) {
      if (!group->is_everyday || !flag.is_everyday) {
        others.push_back(LongName(flag));
        continue;
      }
      flag.text = Gist(flag.text);
      everyday.flags.push_back(std::move(flag));
    }
    if (!everyday.flags.empty()) page.sections.push_back(SectionOf(everyday));
  }
  std::erase(others, "");
  page.description = "";
  absl::StrAppend(&page.synopsis, "\n  ", page.examples[0]);
  page.examples.clear();
  page.more = absl::StrCat("Also ", absl::StrJoin(others, " "), "; ", kProgram, " help --all ",
                           verb.name, " describes every flag");
  return page;
}

Page ProgramPage() {
  Page page{.name = kProgram,
            .summary = "rarely interacting billiards, simulated by a service",
            .synopsis = absl::StrCat(kProgram, " VERB [ARGUMENT...] [FLAG...]"),
            .description =
                "Results go to standard output, everything else to standard error. "
                "help VERB shows the flags of a verb.",
            .examples = {"ballpiston run equilibrium --rho 0.5296 --delta 0.1,0.2",
                         "ballpiston help run"}};
  Section verbs{.title = "Verbs"};
  for (const Verb& verb : Verbs()) verbs.entries.push_back({verb.name, verb.summary});
  page.sections = {verbs,
                   {"Flags without a verb",
                    {{"-h, --help", "print this page"}, {"--version", "print the version"}}},
                   {"Exit codes", kExitCodes},
                   {"Files", kFiles}};
  return page;
}

Page PageOf(const Verb* verb) { return verb == nullptr ? ProgramPage() : PageOf(*verb); }

// The program, and its verbs.
std::vector<const Verb*> AllPages() {
  std::vector<const Verb*> pages = {nullptr};
  for (const Verb& verb : Verbs()) pages.push_back(&verb);
  return pages;
}

// ---- text ----

// Breaks the text into lines of at most kWidth characters. All lines but the first are indented.
std::string Wrapped(absl::string_view text, size_t column, size_t indent) {
  std::string out;
  for (const absl::string_view word : absl::StrSplit(text, ' ')) {
    const bool fits = column + 1 + word.size() <= kWidth;
    if (!out.empty()) {
      absl::StrAppend(&out, fits ? " " : "\n", fits ? "" : std::string(indent, ' '));
      column = fits ? column + 1 : indent;
    }
    absl::StrAppend(&out, word);
    column += word.size();
  }
  return out;
}

// The text beside its term, or below the term if the term is long.
std::string TextEntry(const Remark& entry) {
  constexpr size_t kColumn = 26;
  std::string line = absl::StrCat("  ", entry.name);
  line += line.size() + 2 > kColumn ? "\n" + std::string(kColumn, ' ')
                                    : std::string(kColumn - line.size(), ' ');
  return absl::StrCat(line, Wrapped(entry.text, kColumn, kColumn), "\n");
}

std::string PageText(const Page& page) {
  std::string out = absl::StrCat(page.name, ": ", page.summary, "\n\n  ", page.synopsis, "\n");
  if (!page.description.empty()) {
    absl::StrAppend(&out, "\n", Wrapped(page.description, 0, 0), "\n");
  }
  for (const Section& section : page.sections) {
    absl::StrAppend(&out, "\n", section.title, ":\n");
    for (const Remark& entry : section.entries) out += TextEntry(entry);
  }
  if (!page.examples.empty()) out += "\nExamples:\n";
  for (const std::string& example : page.examples) absl::StrAppend(&out, "  ", example, "\n");
  if (!page.more.empty()) absl::StrAppend(&out, "\n", Wrapped(page.more, 0, 0), "\n");
  return out;
}

// ---- man ----

std::string Roff(const std::string& text) {
  std::string safe = absl::StrReplaceAll(text, {{"\\", "\\e"}, {"-", "\\-"}});
  const bool is_command = absl::StartsWith(safe, ".") || absl::StartsWith(safe, "'");
  return is_command ? absl::StrCat("\\&", safe) : safe;
}

std::string RoffSection(const Section& section) {
  std::string out = absl::StrCat(".SH \"", Roff(section.title), "\"\n");
  for (const Remark& entry : section.entries) {
    absl::StrAppend(&out, ".TP\n.B ", Roff(entry.name), "\n", Roff(entry.text), "\n");
  }
  return out;
}

}  // namespace

std::string TextPage(const Verb* verb) { return PageText(PageOf(verb)); }

std::string ShortPage(const Verb* verb) {
  return verb == nullptr ? TextPage(nullptr) : PageText(ShortPageOf(*verb));
}

std::string GroupPage(const std::string& word) {
  const std::string start = word + " ";
  Page page = ProgramPage();
  page.name += " " + word;
  page.summary = "the verbs of this group";
  page.synopsis = absl::StrCat(page.name, " VERB [ARGUMENT...] [FLAG...]");
  page.sections.resize(1);
  std::erase_if(page.sections[0].entries,
                [&start](const Remark& verb) { return !absl::StartsWith(verb.name, start); });
  if (page.sections[0].entries.empty()) return "";
  page.examples = {absl::StrCat(kProgram, " help ", page.sections[0].entries[0].name)};
  return PageText(page);
}

std::string ManPage(const Verb* verb) {
  const Page page = PageOf(verb);
  std::string out =
      absl::StrCat(".TH ", absl::AsciiStrToUpper(PageName(verb)), " 1 \"\" \"", kProgram, " ",
                   BALLPISTON_VERSION, "\" \"User Commands\"\n.SH NAME\n", Roff(PageName(verb)),
                   " \\- ", Roff(page.summary), "\n.SH SYNOPSIS\n", Roff(page.synopsis), "\n");
  if (!page.description.empty()) {
    absl::StrAppend(&out, ".SH DESCRIPTION\n", Roff(page.description), "\n");
  }
  for (const Section& section : page.sections) out += RoffSection(section);
  out += ".SH EXAMPLES\n";
  for (const std::string& example : page.examples) {
    absl::StrAppend(&out, ".PP\n", Roff(example), "\n");
  }
  std::vector<std::string> others;
  for (const Verb* const other : AllPages()) {
    if ((other == nullptr) != (verb == nullptr)) others.push_back(PageName(other));
  }
  return absl::StrCat(out, ".SH \"SEE ALSO\"\n", Roff(absl::StrJoin(others, "(1), ")), "(1)\n");
}

std::string MarkdownReference() {
  std::string out =
      "# The command line\n\n`ballpiston help --format markdown` writes this file; a test checks "
      "that it is up to date. Most\nverbs have the groups Server and General flags, and run, "
      "submit and sample have the groups\nGrid, Target and Method of plan; only the first such "
      "verb shows them.\n";
  std::set<std::string> shared = {"Server", "General flags"}, shown;
  for (const FlagGroup* group : QuestionFlags()) shared.insert(group->title);
  for (const Verb* const verb : AllPages()) {
    Page page = PageOf(verb);
    std::erase_if(page.sections, [&](const Section& section) {
      return shared.contains(section.title) && !shown.insert(section.title).second;
    });
    absl::StrAppend(&out, "\n## ", page.name, "\n\n```\n", PageText(page), "```\n");
  }
  return out;
}

std::string PageName(const Verb* verb) {
  if (verb == nullptr) return kProgram;
  return absl::StrCat(kProgram, "-", absl::StrReplaceAll(verb->name, {{" ", "-"}}));
}

// ---- the verb ----

namespace {

absl::Status NoPageOf(const std::vector<std::string>& words) {
  std::vector<std::string> names;
  for (const Verb& verb : Verbs()) names.push_back(verb.name);
  return absl::InvalidArgumentError(NotOneOf(absl::StrJoin(words, " "), names));
}

absl::Status WriteManPages(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  absl::Status status;
  for (const Verb* const verb : AllPages()) {
    NewFile file("--out", folder / (PageName(verb) + ".1"));
    file.out() << ManPage(verb);
    status.Update(file.Keep());
  }
  return status;
}

}  // namespace

VerbResult Help(const Options& options, Terminal& terminal) {
  const std::string name = absl::StrJoin(options.words, " ");
  const Verb* const verb = VerbAt(options.words);  // null, for the program's page, without words
  if (name != (verb == nullptr ? "" : verb->name)) {
    const std::string page = options.words.size() == 1 ? GroupPage(name) : "";
    if (page.empty()) return NoPageOf(options.words);
    terminal.out << page;
    return ExitCode::kDone;
  }
  if (!options.out.empty()) {
    if (absl::Status written = WriteManPages(options.out); !written.ok()) return written;
  } else if (options.page == PageFormat::kMarkdown) {
    terminal.out << MarkdownReference();
  } else {
    const bool is_man = options.page == PageFormat::kMan;
    terminal.out << (is_man ? ManPage(verb) : options.all ? TextPage(verb) : ShortPage(verb));
  }
  return ExitCode::kDone;
}

}  // namespace ballpiston::client
