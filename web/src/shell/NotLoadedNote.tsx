import { Alert, Button, Text } from "@mantine/core";
import { IconPlugConnectedX } from "@tabler/icons-react";
import { useEffect, useState } from "react";

const LOOK_EVERY_MS = 1000;
const ANSWER_WITHIN_MS = 3000;
/** A page that cannot be loaded although the server answers is not loaded anew for ever. */
const AGAIN_AFTER_MS = 30_000;
const LAST = "stepscope.reloaded-at";

/** In the place of a page whose script could not be fetched: loads it anew as soon as the server answers. */
export function NotLoadedNote({ why }: { why: string }) {
  const [answers, setAnswers] = useState(false);
  useEffect(() => {
    let ended = false;
    let timer = 0;
    const look = async () => {
      const answer = await fetch("/api/v1/health", { signal: AbortSignal.timeout(ANSWER_WITHIN_MS) }).catch(() => null);
      if (ended) return;
      setAnswers(answer?.ok === true);
      if (answer?.ok && Date.now() - Number(sessionStorage.getItem(LAST) ?? 0) > AGAIN_AFTER_MS) {
        sessionStorage.setItem(LAST, String(Date.now()));
        window.location.reload();
      } else timer = window.setTimeout(look, LOOK_EVERY_MS);
    };
    void look();
    return () => {
      ended = true;
      window.clearTimeout(timer);
    };
  }, []);
  return (
    <Alert
      color="red"
      role="alert"
      icon={<IconPlugConnectedX size={18} aria-hidden />}
      title="This page could not be loaded"
      data-testid="not-loaded"
    >
      <Text size="sm" mb="xs">
        {answers
          ? "The server answers: load the page anew. It may be of another version meanwhile."
          : "The server did not answer. The page is loaded as soon as it does; pages that you have seen still open."}
      </Text>
      <Text size="xs" c="dimmed" mb="xs">
        {why}
      </Text>
      <Button variant="default" onClick={() => window.location.reload()}>
        Reload the page
      </Button>
    </Alert>
  );
}
