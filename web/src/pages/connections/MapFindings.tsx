import { ApiError } from "../../api/client";
import css from "./connections.module.css";
import type { Finding } from "./useRegisterMaps";

/** What is wrong with a map, line by line. */
export function Findings({ findings, more = 0, of }: { findings: readonly Finding[]; more?: number; of: string }) {
  if (findings.length === 0) return null;
  return (
    <ul className={`${css.findings} list`} aria-label={`Mistakes in ${of}`}>
      {findings.map((each) => (
        <li key={`${each.line} ${each.where} ${each.what}`}>
          <b className="num">line {each.line}</b> {each.where && <>{each.where}: </>}
          {each.what}
        </li>
      ))}
      {more > 0 && <li>and {more} more</li>}
    </ul>
  );
}

/** What the server found wrong with a file that it has refused. */
export function findingsOf(error: unknown): Finding[] {
  const facts = error instanceof ApiError ? error.problem.facts : {};
  return Array.isArray(facts.findings) ? (facts.findings as Finding[]) : [];
}
