#pragma once

#include <tinyxml2.h>

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "posewise/core/errors.hpp"

namespace posewise::io {

/// `<name ...>` or `<name .../>` in a text.
struct StartTag {
    std::size_t begin = 0;  ///< of the '<'
    std::size_t end = 0;    ///< behind the '>'
    std::string name;
};

/// A whole XML file that knows where each element stands. Nothing is ever expanded or fetched.
class XmlDocument {
  public:
    /// Throws InputError with the place for what is not XML, and for what no file of a person
    /// needs and only an attack has: over 4 MiB, a document type (and so entities of its own),
    /// tags over 64 KiB, elements nested more than 50 deep, NUL bytes.
    explicit XmlDocument(const std::string& path);

    const std::string& path() const { return path_; }
    const std::string& content() const { return content_; }
    const tinyxml2::XMLElement& root() const { return *document_.RootElement(); }

    const StartTag& tag(const tinyxml2::XMLElement& element) const;
    /// The start tags in the order of the file.
    const std::vector<StartTag>& tags() const { return tags_; }

    FileLocation location(std::size_t position) const;
    /// Where the element begins.
    FileLocation location(const tinyxml2::XMLElement& element) const;
    /// `path:line:column: problem` of the element.
    InputError error(const tinyxml2::XMLElement& element, const std::string& problem) const;

  private:
    long column(std::size_t position) const;
    void scan();
    std::size_t skip_start_tag(std::size_t position);
    std::size_t find_end(std::size_t position, std::string_view ending, const char* what) const;
    void parse();
    void number(const tinyxml2::XMLElement& element);

    std::string path_;
    std::string content_;
    std::vector<StartTag> tags_;
    tinyxml2::XMLDocument document_;
    std::unordered_map<const tinyxml2::XMLElement*, std::size_t> tag_of_;
};

}  // namespace posewise::io
