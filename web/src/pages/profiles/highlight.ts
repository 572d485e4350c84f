export type Language = "python" | "tmcl" | "c" | "curl";
export type Kind = "plain" | "remark" | "word" | "text" | "number";

export interface Token {
  kind: Kind;
  text: string;
}

interface Grammar {
  remark: RegExp;
  text: RegExp;
  words: readonly string[];
}

const PYTHON = "and as def else except False for from if import in is None not or return True try while with".split(
  " ",
);
const C = "const define endif for if ifndef include inline int return size_t sizeof static struct typedef void".split(
  " ",
);
const SHELL = "case do done else esac exit fi for if in printf put set then while".split(" ");
const TMCL = "SAP SGP STGP STOP SIO SCO".split(" ");

// each of them is tried at one place of the text: sticky
const GRAMMARS: Record<Language, Grammar> = {
  python: { remark: /#.*/y, text: /"""[\s\S]*?"""|f?"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*'/y, words: PYTHON },
  c: { remark: /\/\*[\s\S]*?\*\//y, text: /"(?:[^"\\\n]|\\.)*"|<\w+\.h>/y, words: C },
  curl: { remark: /#.*/y, text: /'[^']*'|"(?:[^"\\]|\\[\s\S])*"/y, words: SHELL },
  tmcl: { remark: /\/\/.*/y, text: /(?!)/y, words: TMCL },
};
const NUMBER = /(?:0x[0-9A-Fa-f]+|\d+(?:\.\d+)?)u?(?!\w)/y;
const WORD = /[A-Za-z_]\w*/y;
/** `${1-bench}`, `$#` and the like: what follows a dollar begins no remark. */
const DOLLAR = /\$\{[^}]*\}|\$./y;

function at(pattern: RegExp, text: string, place: number): string {
  pattern.lastIndex = place;
  return pattern.exec(text)?.[0] ?? "";
}

/** A program in pieces of one kind each; put together they are the text, letter by letter. */
export function tokensOf(text: string, language: Language): Token[] {
  const { remark, text: quoted, words } = GRAMMARS[language];
  const tokens: Token[] = [];
  const push = (kind: Kind, piece: string) => {
    const last = tokens[tokens.length - 1];
    if (last?.kind === kind) last.text += piece;
    else tokens.push({ kind, text: piece });
  };
  let place = 0;
  while (place < text.length) {
    const dollar = language === "curl" ? at(DOLLAR, text, place) : "";
    const found: [Kind, string] = dollar ? ["plain", dollar] : read(remark, quoted, words, text, place);
    push(...found);
    place += found[1].length;
  }
  return tokens;
}

function read(remark: RegExp, quoted: RegExp, words: readonly string[], text: string, place: number): [Kind, string] {
  const comment = at(remark, text, place);
  if (comment) return ["remark", comment];
  const quote = at(quoted, text, place);
  if (quote) return ["text", quote];
  const word = at(WORD, text, place);
  if (word) return [words.includes(word) ? "word" : "plain", word];
  const number = at(NUMBER, text, place);
  if (number) return ["number", number];
  return ["plain", text.charAt(place)];
}
