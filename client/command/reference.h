// Makes help, man pages and the reference in Markdown from the table of verbs.
#pragma once

#include <string>

#include "client/command/verb_table.h"

namespace ballpiston::client {

// The whole page of a verb; null gives the program's page.
std::string TextPage(const Verb* verb);
// At most kScreen lines: the everyday flags in a few words, and the names of the others.
inline constexpr int kScreen = 40;
std::string ShortPage(const Verb* verb);
// The page of the verbs that begin with this word, such as server; empty if no verb does.
std::string GroupPage(const std::string& word);
std::string ManPage(const Verb* verb);

// All pages as one document.
std::string MarkdownReference();

// ballpiston-server-start for the verb `server start`; null gives ballpiston.
std::string PageName(const Verb* verb);

}  // namespace ballpiston::client
