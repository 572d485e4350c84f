import { useCallback, useState } from "react";

export interface Failure {
  doing: string;
  error: unknown;
}

/** Runs what a button asks for; keeps the last failure until something works, and what was said along with success. */
export function useAction() {
  const [failure, setFailure] = useState<Failure | null>(null);
  const [notes, setNotes] = useState<readonly string[]>([]);
  const [busy, setBusy] = useState(false);

  const run = useCallback(async (doing: string, action: () => Promise<unknown>): Promise<boolean> => {
    setBusy(true);
    try {
      const answer = await action();
      setFailure(null);
      const all = Array.isArray(answer) ? answer : [answer];
      setNotes(
        all.flatMap((part) =>
          typeof part === "object" && part !== null && "warnings" in part ? (part.warnings as string[]) : [],
        ),
      );
      return true;
    } catch (error) {
      setFailure({ doing, error });
      return false;
    } finally {
      setBusy(false);
    }
  }, []);

  const fail = useCallback((doing: string, error: unknown) => setFailure({ doing, error }), []);
  const dismiss = useCallback(() => {
    setFailure(null);
    setNotes([]);
  }, []);
  return { run, fail, dismiss, failure, notes, busy };
}

export type Action = ReturnType<typeof useAction>;
