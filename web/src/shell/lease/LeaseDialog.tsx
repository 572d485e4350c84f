import { Button, Group, Modal, Stack, Text } from "@mantine/core";
import { type FormEvent, useState } from "react";
import { leaseClient } from "../../api/lease/bench";
import { type Cause, isFree, type Lease, type Question } from "../../api/lease/LeaseClient";
import { savedName, saveName, userName } from "../../api/lease/session";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { NameField } from "./NameField";
import { useLease } from "./useLease";
import { lasting } from "./words";

const FREE: Readonly<Record<Cause, string>> = {
  change: "Take the bench and go on?",
  held: "Take the bench? Then hold the button again.",
};

/** Opened by the first thing that would change a bench that is not ours; what was asked for waits behind it. */
export function LeaseDialog() {
  const { lease, question, asking, problem } = useLease();
  // What closes keeps its words until it is gone.
  const [shown, setShown] = useState<{ lease: Lease; question: Question } | null>(null);
  if (lease && question && (shown?.lease !== lease || shown.question !== question)) setShown({ lease, question });
  return (
    <Modal
      opened={question !== null && lease !== null}
      onClose={() => void leaseClient.answer(false)}
      title="You are only looking"
      size="sm"
      centered
      closeButtonProps={{ "aria-label": "Close" }}
      transitionProps={{ duration: 120 }}
    >
      {shown && <Body {...shown} asking={asking} />}
      {problem !== null && question !== null && <ProblemAlert error={problem} />}
    </Modal>
  );
}

function Body({ lease, question, asking }: { lease: Lease; question: Question; asking: boolean }) {
  const [named] = useState(() => savedName() !== null);
  const taken = !isFree(lease) && !lease.mine;
  const act = (event: FormEvent) => {
    event.preventDefault();
    if (!named) saveName(userName()); // asked once, also of one who likes what is proposed
    void (taken ? leaseClient.ask() : leaseClient.answer(true));
  };
  return (
    <form onSubmit={act}>
      <Stack gap="sm">
        <Words lease={lease} question={question} asking={asking} />
        {!named && <NameField />}
        <Group gap="xs" justify="flex-end">
          <Button variant="default" size="sm" onClick={() => void leaseClient.answer(false)}>
            {lease.mine ? "Not now" : "Only look"}
          </Button>
          {taken ? (
            <Button type="submit" size="sm" data-autofocus loading={asking} loaderProps={{ type: "dots" }}>
              Ask {lease.holder} for it
            </Button>
          ) : (
            <Button type="submit" size="sm" data-autofocus>
              {lease.mine ? (question.cause === "change" ? "Go on" : "Good") : "Take the bench"}
            </Button>
          )}
        </Group>
      </Stack>
    </form>
  );
}

function Words({ lease, question, asking }: { lease: Lease; question: Question; asking: boolean }) {
  if (lease.mine)
    return (
      <Text size="sm" role="status">
        {question.handed ? "The bench was handed to you." : "You have the bench now."}{" "}
        {question.cause === "change" && "Go on with what you wanted?"}
        {question.cause === "held" && "Hold the button again."}
      </Text>
    );
  if (isFree(lease)) return <Text size="sm">{FREE[question.cause]}</Text>;
  return (
    <>
      <Text size="sm">
        <b>{lease.holder}</b> has the bench, for {lasting(lease.since_s)}.{" "}
        {question.cause === "change" && "Nothing was sent yet: it waits for your answer."}
      </Text>
      <Text size="xs" c="dimmed" role="status">
        {asking
          ? `${lease.holder} sees that you ask. This window tells when the bench is yours.`
          : `Without a sign of ${lease.holder} it is free in ${lasting(lease.expires_in_s)}.`}
      </Text>
    </>
  );
}
