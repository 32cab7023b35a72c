# A header as Doxygen wants it: its plain `//` comments become documentation.
#
# The first comment of a file is about the file. Text that is indented, such as a formula, becomes a
# block of code and is taken as it stands; elsewhere characters that mean something to Doxygen are
# quoted. A comment behind a member is about that member. A type without a comment of its own is what
# the head of its file is about.

function quoted(text) {
  gsub(/[\\@<>#%]/, "\\\\&", text)
  return text
}

/^ *\/\/ (clang-format|NOLINT)/ { next }

/^ *\/\/( |$)/ {
  indent = $0
  sub(/\/\/.*/, "", indent)
  text = substr($0, length(indent) + 3)
  kind = text ~ /^ *$/ ? "blank" : text ~ /^   / ? "code" : "words"
  if (NR == 1) print "/// \\file"
  if (last != "" && last != kind && last != "blank" && kind != "blank") print indent "///"
  if (kind == "words") text = quoted(text)
  print indent (kind == "code" ? "///   " : "///") text
  last = kind
  documented = 1
  next
}

{ last = "" }

/^(struct|class) .*\{/ && !documented {
  file = FILENAME
  sub(/.*\//, "", file)
  print "/// The head of \\ref " file " tells what it is for."
}

!/^template/ { documented = 0 }

/^ *[^ \/].*[^ ]  \/\/ / {
  at = index($0, "  // ")
  $0 = substr($0, 1, at - 1) "  ///< " quoted(substr($0, at + 5))
}

{ print }
