// CodeMirror: completion, hover, gutters and marks of lines that also work with a keyboard and a screen reader are years
// of work. It comes with this page alone, and never with the first one.
import { autocompletion, type CompletionContext, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap } from "@codemirror/commands";
import { HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { Compartment, EditorState, type Extension, RangeSet, StateEffect, StateField } from "@codemirror/state";
import {
  Decoration,
  drawSelection,
  EditorView,
  GutterMarker,
  gutter,
  highlightActiveLine,
  highlightActiveLineGutter,
  hoverTooltip,
  keymap,
  lineNumbers,
} from "@codemirror/view";
import { tags } from "@lezer/highlight";
import { type Ref, useEffect, useImperativeHandle, useLayoutEffect, useRef } from "react";
import css from "./program.module.css";
import { type Help, helpAt, type Kind, type Problem, proposalsAt, type Token, tokensOf, type Words } from "./words";

export interface EditorHandle {
  goTo: (line: number, column?: number) => void;
  setText: (text: string) => void;
  cursorLine: () => number;
  toggleBreakpoint: () => void;
  focus: () => void;
}

interface Props {
  ref: Ref<EditorHandle>;
  text: string;
  words: Words | null;
  problems: readonly Problem[];
  /** lines with a breakpoint, from 1, as they are at the start */
  breakpoints: readonly number[];
  /** where the program is; null where that is not known, or not in this text */
  currentLine: number | null;
  readOnly: boolean;
  onText: (text: string) => void;
  onBreakpoints: (lines: number[]) => void;
  /** what the word at the cursor means */
  onHelp: (help: Help | null) => void;
}

// --- highlighting -----------------------------------------------------------------------------------

const TAGS: Readonly<Record<Kind, string | null>> = {
  comment: "comment",
  command: "keyword",
  label: "labelName",
  number: "number",
  name: "variableName",
  include: "meta",
  unknown: "invalid",
  mark: null,
};

const STYLE = HighlightStyle.define([
  { tag: tags.comment, color: "var(--dim)", fontStyle: "italic" },
  { tag: tags.keyword, color: "var(--accent-text)", fontWeight: "600" },
  { tag: tags.labelName, color: "var(--violet)", fontWeight: "600" },
  { tag: tags.number, color: "var(--good)" },
  { tag: tags.variableName, color: "var(--ink-soft)" },
  { tag: tags.meta, color: "var(--caution)" },
  { tag: tags.invalid, color: "var(--fault)" },
]);

function languageOf(words: Words | null): Extension {
  const mnemonics = new Set([".COMMAND", ...(words?.commands.map(({ mnemonic }) => mnemonic) ?? [])]);
  const known = (word: string) => words === null || mnemonics.has(word.toUpperCase());
  return StreamLanguage.define<{ tokens: Token[] }>({
    startState: () => ({ tokens: [] }),
    copyState: ({ tokens }) => ({ tokens }),
    token(stream, state) {
      if (stream.sol()) state.tokens = tokensOf(stream.string, known);
      const next = state.tokens.find(({ to }) => to > stream.pos);
      if (next === undefined) {
        stream.skipToEnd();
        return null;
      }
      if (next.from > stream.pos) {
        stream.pos = next.from;
        return null;
      }
      stream.pos = next.to;
      return TAGS[next.kind];
    },
  });
}

// --- breakpoints and the current line ---------------------------------------------------------------

class Dot extends GutterMarker {
  override toDOM() {
    const dot = document.createElement("span");
    dot.className = css.breakpoint ?? "";
    return dot;
  }
}
const DOT = new Dot();
const toggled = StateEffect.define<number>();
const current = StateEffect.define<number | null>();

const breakpointField = StateField.define<RangeSet<GutterMarker>>({
  create: () => RangeSet.empty,
  update(set, change) {
    let next = change.docChanged ? set.map(change.changes) : set;
    for (const effect of change.effects)
      if (effect.is(toggled)) {
        let there = false;
        next.between(effect.value, effect.value, () => {
          there = true;
        });
        next = next.update(
          there ? { filter: (from) => from !== effect.value } : { add: [DOT.range(effect.value)], sort: true },
        );
      }
    return next;
  },
});

function linesOf(state: EditorState): number[] {
  const lines: number[] = [];
  for (const cursor = state.field(breakpointField).iter(); cursor.value; cursor.next())
    lines.push(state.doc.lineAt(cursor.from).number);
  return [...new Set(lines)];
}

const CURRENT = Decoration.line({ class: css.current ?? "", attributes: { "data-current": "true" } });
const currentField = StateField.define({
  create: () => Decoration.none,
  update(set, change) {
    let next = set.map(change.changes);
    for (const effect of change.effects)
      if (effect.is(current)) {
        const line = effect.value;
        const known = line !== null && line >= 1 && line <= change.state.doc.lines;
        next = known ? Decoration.set([CURRENT.range(change.state.doc.line(line).from)]) : Decoration.none;
      }
    return next;
  },
  provide: (field) => EditorView.decorations.from(field),
});

const BREAKPOINTS: Extension = [
  breakpointField,
  gutter({
    class: css.gutter ?? "",
    markers: (view) => view.state.field(breakpointField),
    initialSpacer: () => DOT,
    domEventHandlers: {
      mousedown(view, line) {
        view.dispatch({ effects: toggled.of(line.from) });
        return true;
      },
    },
  }),
];

// --- the editor -------------------------------------------------------------------------------------

function diagnosticsOf(state: EditorState, problems: readonly Problem[]): Diagnostic[] {
  return problems.flatMap((problem) => {
    if (problem.line < 1 || problem.line > state.doc.lines) return [];
    const line = state.doc.line(problem.line);
    const from = Math.min(line.to, line.from + Math.max(0, problem.column - 1));
    const length = /^[^\s,]+/.exec(line.text.slice(from - line.from))?.[0].length ?? 1;
    return [{ from, to: Math.min(line.to, from + length), severity: "error" as const, message: problem.message }];
  });
}

/** The language, once it is there. */
function whenThere() {
  let resolve: (words: Words) => void = () => {};
  const promise = new Promise<Words>((resolved) => {
    resolve = resolved;
  });
  return { promise, resolve };
}

/** The text of a program, with all that helps writing it. Tab leaves it: Ctrl ] and Ctrl [ indent. */
export function Editor(props: Props) {
  const { ref, words, problems, currentLine, readOnly } = props;
  const place = useRef<HTMLDivElement>(null);
  const view = useRef<EditorView | null>(null);
  const latest = useRef(props);
  latest.current = props;
  const ready = useRef(whenThere());
  const parts = useRef({ language: new Compartment(), reading: new Compartment() });

  useEffect(() => {
    const { text, breakpoints, words: first, readOnly: reading } = latest.current;
    const wordsNow = () => latest.current.words;
    const complete = async (context: CompletionContext) => {
      const known = wordsNow() ?? (await ready.current.promise); // asked before the language was there: when it comes
      const line = context.state.doc.lineAt(context.pos);
      const found = proposalsAt(context.state.doc.toString(), line.text, context.pos - line.from, known);
      if (found === null || (!context.explicit && found.from === context.pos - line.from && !/[ ,]$/.test(line.text)))
        return null;
      if (!context.explicit && found.from === context.pos - line.from && line.text.trim() === "") return null;
      return {
        from: line.from + found.from,
        options: found.options.map(({ label, apply, detail, info, type }) => ({
          label,
          detail,
          type,
          ...(info ? { info } : {}),
          ...(apply ? { apply } : {}),
        })),
        validFor: /^[#.]?\w*$/,
      };
    };
    const help = (state: EditorState, at: number): Help | null => {
      const known = wordsNow();
      const line = state.doc.lineAt(at);
      return known && helpAt(state.doc.toString(), line.text, at - line.from, known);
    };
    const made = new EditorView({
      parent: place.current as HTMLDivElement,
      state: EditorState.create({
        doc: text,
        extensions: [
          BREAKPOINTS,
          lintGutter(),
          lineNumbers(),
          history(),
          drawSelection(),
          highlightActiveLine(),
          highlightActiveLineGutter(),
          currentField,
          autocompletion({ override: [complete], icons: false }),
          hoverTooltip((editor, at) => {
            const found = help(editor.state, at);
            if (found === null) return null;
            const start = editor.state.doc.lineAt(at).from;
            return {
              pos: start + found.from,
              end: start + found.to,
              create: () => {
                const dom = document.createElement("div");
                dom.className = css.hover ?? "";
                const title = dom.appendChild(document.createElement("b"));
                title.textContent = found.title;
                dom.appendChild(document.createElement("div")).textContent = found.text;
                return { dom };
              },
            };
          }),
          keymap.of([...completionKeymap, ...historyKeymap, ...defaultKeymap]),
          syntaxHighlighting(STYLE),
          parts.current.language.of(languageOf(first)),
          parts.current.reading.of(EditorState.readOnly.of(reading)),
          EditorView.contentAttributes.of({
            "aria-label": "Program text",
            "data-testid": "program-text",
            tabindex: "0",
          }),
          EditorView.updateListener.of((update) => {
            if (update.docChanged) latest.current.onText(update.state.doc.toString());
            if (
              update.docChanged ||
              update.transactions.some(({ effects }) => effects.some((each) => each.is(toggled)))
            ) {
              const lines = linesOf(update.state);
              if (lines.join() !== latest.current.breakpoints.join()) latest.current.onBreakpoints(lines);
            }
            if (update.docChanged || update.selectionSet)
              latest.current.onHelp(help(update.state, update.state.selection.main.head));
          }),
        ],
      }),
    });
    const effects = breakpoints
      .filter((line) => line >= 1 && line <= made.state.doc.lines)
      .map((line) => toggled.of(made.state.doc.line(line).from));
    if (effects.length > 0) made.dispatch({ effects });
    view.current = made;
    return () => {
      view.current = null;
      made.destroy();
    };
  }, []);

  useEffect(() => {
    if (words !== null) ready.current.resolve(words);
    view.current?.dispatch({ effects: parts.current.language.reconfigure(languageOf(words)) });
  }, [words]);
  useEffect(() => {
    view.current?.dispatch({ effects: parts.current.reading.reconfigure(EditorState.readOnly.of(readOnly)) });
  }, [readOnly]);
  useLayoutEffect(() => {
    const { current: editor } = view;
    if (editor) editor.dispatch(setDiagnostics(editor.state, diagnosticsOf(editor.state, problems)));
  }, [problems]);
  useEffect(() => {
    const { current: editor } = view;
    if (!editor) return;
    const known = currentLine !== null && currentLine >= 1 && currentLine <= editor.state.doc.lines;
    editor.dispatch({
      effects: [
        current.of(currentLine),
        ...(known ? [EditorView.scrollIntoView(editor.state.doc.line(currentLine).from, { y: "nearest" })] : []),
      ],
    });
  }, [currentLine]);

  useImperativeHandle(ref, () => ({
    goTo(line, column = 1) {
      const { current: editor } = view;
      if (!editor || line < 1 || line > editor.state.doc.lines) return;
      const at = editor.state.doc.line(line);
      editor.dispatch({ selection: { anchor: Math.min(at.to, at.from + column - 1) }, scrollIntoView: true });
      editor.focus();
    },
    setText(text) {
      const { current: editor } = view;
      editor?.dispatch({ changes: { from: 0, to: editor.state.doc.length, insert: text } });
    },
    cursorLine() {
      const { current: editor } = view;
      return editor ? editor.state.doc.lineAt(editor.state.selection.main.head).number : 1;
    },
    toggleBreakpoint() {
      const { current: editor } = view;
      if (editor)
        editor.dispatch({ effects: toggled.of(editor.state.doc.lineAt(editor.state.selection.main.head).from) });
    },
    focus: () => view.current?.focus(),
  }));

  return <div ref={place} className={css.editor} />;
}
