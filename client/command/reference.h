// Help, man pages and the reference in Markdown, made from the table of verbs.
#ifndef BALLPISTON_CLIENT_COMMAND_REFERENCE_H_
#define BALLPISTON_CLIENT_COMMAND_REFERENCE_H_

#include <string>

#include "client/command/verb_table.h"

namespace ballpiston::client {

// The page of a verb; of the program for null.
std::string TextPage(const Verb* verb);
// The verbs that begin with this word, as server; empty if there are none.
std::string GroupPage(const std::string& word);
std::string ManPage(const Verb* verb);

// All pages as one document.
std::string MarkdownReference();

// ballpiston-server-start for the verb server start; ballpiston for null.
std::string PageName(const Verb* verb);

}  // namespace ballpiston::client

#endif  // BALLPISTON_CLIENT_COMMAND_REFERENCE_H_
