import { Textarea } from "@mantine/core";
import { useEffect, useState } from "react";
import { Card } from "../../lib/Card";
import type { LooseProps } from "../panel";
import { NOTES_MAX, type NotesConfig } from "./notes";

/** Typing is put into the layout when it has stood still so long, or is left: who saves then has all of it. */
const SETTLED_MS = 400;

/** What people write beside what they do; it is saved with the layout. */
export function NotesPanel({ id, config, change }: LooseProps<NotesConfig>) {
  const [text, setText] = useState(config.text);
  const [seen, setSeen] = useState(config.text);
  if (config.text !== seen) {
    setSeen(config.text);
    setText(config.text);
  }
  useEffect(() => {
    if (text === config.text) return;
    const timer = setTimeout(() => change({ text }), SETTLED_MS);
    return () => clearTimeout(timer);
  }, [text, config.text, change]);
  return (
    <Card title="Notes" className="stack grow">
      <Textarea
        aria-label={`Notes ${id}`}
        autosize
        minRows={4}
        maxLength={NOTES_MAX}
        value={text}
        placeholder="What was tried, and what came of it"
        onChange={(event) => setText(event.currentTarget.value)}
        onBlur={() => text !== config.text && change({ text })}
      />
    </Card>
  );
}
