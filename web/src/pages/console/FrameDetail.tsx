import { ActionIcon } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { duration } from "../../lib/format";
import { Bytes } from "./Bytes";
import css from "./console.module.css";
import { bytesOf, replyFields, requestFields } from "./frames";
import { clock, type Frame } from "./log";

/** One frame of the log, byte by byte. */
export function FrameDetail({ frame, onClose }: { frame: Frame; onClose: () => void }) {
  const request = bytesOf(frame.tx);
  return (
    <section className={css.detail} aria-label="The chosen frame">
      <div className={css.detailHead}>
        <b>{frame.text}</b>
        <span className={css.dim}>
          <span className="num">{clock(frame.time_unix_s)}</span>, {frame.priority}, took{" "}
          <span className="num">{duration(frame.took_ms / 1000)}</span>
        </span>
        <ActionIcon size={20} variant="subtle" color="gray" ml="auto" aria-label="Close the frame" onClick={onClose}>
          <IconX size={13} />
        </ActionIcon>
      </div>
      {frame.error !== null && <p className={css.problem}>{frame.error}</p>}
      <Bytes label="request" fields={requestFields(request)} />
      {frame.rx !== null && <Bytes label="reply" fields={replyFields(request, bytesOf(frame.rx))} />}
    </section>
  );
}
