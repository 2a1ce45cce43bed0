--
-- PostgreSQL database dump
--


-- Dumped from database version 15.18 (Debian 15.18-0+deb12u1)
-- Dumped by pg_dump version 15.18 (Debian 15.18-0+deb12u1)

SET statement_timeout = 0;
SET lock_timeout = 0;
SET idle_in_transaction_session_timeout = 0;
SET client_encoding = 'UTF8';
SET standard_conforming_strings = on;
SELECT pg_catalog.set_config('search_path', '', false);
SET check_function_bodies = false;
SET xmloption = content;
SET client_min_messages = warning;
SET row_security = off;

--
-- Name: refuse_change(); Type: FUNCTION; Schema: public; Owner: -
--

CREATE FUNCTION public.refuse_change() RETURNS trigger
    LANGUAGE plpgsql
    AS $$
BEGIN RAISE EXCEPTION '% is append-only', TG_TABLE_NAME; END;
$$;


SET default_tablespace = '';

SET default_table_access_method = heap;

--
-- Name: alembic_version; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.alembic_version (
    version_num character varying(32) NOT NULL
);


--
-- Name: attempts; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.attempts (
    id bigint NOT NULL,
    case_id character varying,
    user_id character varying,
    trigger character varying NOT NULL,
    accepted boolean NOT NULL,
    code character varying NOT NULL,
    message character varying NOT NULL,
    state character varying,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: attempts_id_seq; Type: SEQUENCE; Schema: public; Owner: -
--

CREATE SEQUENCE public.attempts_id_seq
    START WITH 1
    INCREMENT BY 1
    NO MINVALUE
    NO MAXVALUE
    CACHE 1;


--
-- Name: attempts_id_seq; Type: SEQUENCE OWNED BY; Schema: public; Owner: -
--

ALTER SEQUENCE public.attempts_id_seq OWNED BY public.attempts.id;


--
-- Name: audit_events; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.audit_events (
    id bigint NOT NULL,
    kind character varying NOT NULL,
    user_id character varying,
    data json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: audit_events_id_seq; Type: SEQUENCE; Schema: public; Owner: -
--

CREATE SEQUENCE public.audit_events_id_seq
    START WITH 1
    INCREMENT BY 1
    NO MINVALUE
    NO MAXVALUE
    CACHE 1;


--
-- Name: audit_events_id_seq; Type: SEQUENCE OWNED BY; Schema: public; Owner: -
--

ALTER SEQUENCE public.audit_events_id_seq OWNED BY public.audit_events.id;


--
-- Name: cases; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.cases (
    id character varying NOT NULL,
    room character varying(64) NOT NULL,
    patient_id character varying NOT NULL,
    study_uid character varying NOT NULL,
    opened_by character varying NOT NULL,
    product_version character varying NOT NULL,
    settings_sha256 character varying(64) NOT NULL,
    devices json NOT NULL,
    opened_at character varying(32) NOT NULL
);


--
-- Name: checkpoints; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.checkpoints (
    sequence bigint NOT NULL,
    statement text NOT NULL,
    signature character varying(128) NOT NULL
);


--
-- Name: device_files; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.device_files (
    id character varying NOT NULL,
    kind character varying(8) NOT NULL,
    name character varying NOT NULL,
    version character varying NOT NULL,
    sha256 character varying(64) NOT NULL,
    expires character varying(10),
    content bytea NOT NULL,
    uploaded_by character varying NOT NULL,
    "position" integer NOT NULL,
    uploaded_at character varying(32) NOT NULL
);


--
-- Name: evaluations; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.evaluations (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL,
    image_id character varying NOT NULL
);


--
-- Name: events; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.events (
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    version integer NOT NULL,
    trigger character varying NOT NULL,
    user_id character varying,
    state character varying NOT NULL,
    case_state json NOT NULL,
    data json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: idempotency_keys; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.idempotency_keys (
    user_id character varying NOT NULL,
    key character varying(128) NOT NULL,
    request_sha256 character varying(64) NOT NULL,
    status integer NOT NULL,
    body json NOT NULL,
    version integer,
    created_at character varying(32) NOT NULL
);


--
-- Name: image_bytes; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.image_bytes (
    sha256 character varying(64) NOT NULL,
    content bytea NOT NULL
);


--
-- Name: image_purposes; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.image_purposes (
    image_id character varying NOT NULL,
    case_id character varying,
    purpose character varying NOT NULL,
    arm json NOT NULL,
    verdicts json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: images; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.images (
    id character varying NOT NULL,
    "position" integer NOT NULL,
    sha256 character varying(64) NOT NULL,
    sop_uid character varying,
    pixel_sha256 character varying(64),
    duplicate_of character varying,
    patient_id character varying,
    study_uid character varying,
    problem json,
    source json NOT NULL,
    metadata json NOT NULL,
    received_at character varying(32) NOT NULL
);


--
-- Name: insertions; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.insertions (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: leases; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.leases (
    case_id character varying NOT NULL,
    fencing_token integer NOT NULL,
    session_id character varying NOT NULL,
    user_id character varying NOT NULL,
    reason character varying NOT NULL,
    taken_at character varying(32) NOT NULL
);


--
-- Name: ledger; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.ledger (
    sequence bigint NOT NULL,
    entry text NOT NULL,
    sha256 character varying(64) NOT NULL,
    reached_at character varying(32) NOT NULL,
    case_id character varying,
    actor character varying,
    action character varying NOT NULL,
    attempt_id bigint
);


--
-- Name: lock_outs; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.lock_outs (
    subject character varying NOT NULL,
    until_s double precision NOT NULL
);


--
-- Name: motions; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.motions (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL,
    trajectory bytea
);


--
-- Name: permit_uses; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.permit_uses (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: permits; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.permits (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL,
    approved_by character varying NOT NULL
);


--
-- Name: planned_targets; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.planned_targets (
    case_id character varying NOT NULL,
    name character varying NOT NULL,
    content json NOT NULL
);


--
-- Name: plans; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.plans (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: registrations; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.registrations (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL,
    image_id character varying NOT NULL
);


--
-- Name: room_claims; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.room_claims (
    room character varying(64) NOT NULL,
    holder character varying NOT NULL,
    claimed_at character varying(32) NOT NULL
);


--
-- Name: sessions; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.sessions (
    id character varying NOT NULL,
    token_sha256 character varying(64) NOT NULL,
    user_id character varying NOT NULL,
    created_at character varying(32) NOT NULL,
    expires_at_s double precision NOT NULL,
    last_seen_at_s double precision NOT NULL,
    locked_at character varying(32),
    revoked_at character varying(32)
);


--
-- Name: targets; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.targets (
    id character varying NOT NULL,
    case_id character varying NOT NULL,
    sequence integer NOT NULL,
    made_from json NOT NULL,
    content json NOT NULL,
    recorded_at character varying(32) NOT NULL
);


--
-- Name: users; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.users (
    id character varying NOT NULL,
    name character varying(64) NOT NULL,
    role character varying(16) NOT NULL,
    password_hash character varying NOT NULL,
    pin_hash character varying NOT NULL,
    created_at character varying(32) NOT NULL,
    disabled_at character varying(32)
);


--
-- Name: verdicts; Type: TABLE; Schema: public; Owner: -
--

CREATE TABLE public.verdicts (
    id bigint NOT NULL,
    attempt_id bigint NOT NULL,
    code character varying NOT NULL,
    hazard character varying NOT NULL,
    passed boolean NOT NULL,
    measured json,
    "limit" json,
    unit character varying NOT NULL,
    message character varying NOT NULL
);


--
-- Name: verdicts_id_seq; Type: SEQUENCE; Schema: public; Owner: -
--

CREATE SEQUENCE public.verdicts_id_seq
    START WITH 1
    INCREMENT BY 1
    NO MINVALUE
    NO MAXVALUE
    CACHE 1;


--
-- Name: verdicts_id_seq; Type: SEQUENCE OWNED BY; Schema: public; Owner: -
--

ALTER SEQUENCE public.verdicts_id_seq OWNED BY public.verdicts.id;


--
-- Name: attempts id; Type: DEFAULT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.attempts ALTER COLUMN id SET DEFAULT nextval('public.attempts_id_seq'::regclass);


--
-- Name: audit_events id; Type: DEFAULT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.audit_events ALTER COLUMN id SET DEFAULT nextval('public.audit_events_id_seq'::regclass);


--
-- Name: verdicts id; Type: DEFAULT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.verdicts ALTER COLUMN id SET DEFAULT nextval('public.verdicts_id_seq'::regclass);


--
-- Data for Name: alembic_version; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.alembic_version VALUES ('0002');


--
-- Data for Name: attempts; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.attempts VALUES (1, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.392012Z');
INSERT INTO public.attempts VALUES (2, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.413788Z');
INSERT INTO public.attempts VALUES (3, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.431615Z');
INSERT INTO public.attempts VALUES (4, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.445732Z');
INSERT INTO public.attempts VALUES (5, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.461466Z');
INSERT INTO public.attempts VALUES (6, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.477218Z');
INSERT INTO public.attempts VALUES (7, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.490533Z');
INSERT INTO public.attempts VALUES (8, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.505798Z');
INSERT INTO public.attempts VALUES (9, 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_closed', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.515698Z');
INSERT INTO public.attempts VALUES (10, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.529594Z');
INSERT INTO public.attempts VALUES (11, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.547095Z');
INSERT INTO public.attempts VALUES (12, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.557942Z');
INSERT INTO public.attempts VALUES (13, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.570531Z');
INSERT INTO public.attempts VALUES (14, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.592615Z');
INSERT INTO public.attempts VALUES (15, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.603019Z');
INSERT INTO public.attempts VALUES (16, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.610632Z');
INSERT INTO public.attempts VALUES (17, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.629240Z');
INSERT INTO public.attempts VALUES (18, 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_closed', true, 'taken', '', 'case_open', '2026-11-22T09:22:42.639125Z');


--
-- Data for Name: audit_events; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.audit_events VALUES (1, 'user_added', NULL, '{"name":"anna","role":"surgeon","user_id":"22a1ffd77abd4f7d9487bf17eb9b679d"}', '2026-11-22T09:22:42.294537Z');
INSERT INTO public.audit_events VALUES (2, 'signed_in', '22a1ffd77abd4f7d9487bf17eb9b679d', '{"session":"s-1"}', '2026-11-22T09:22:42.329525Z');
INSERT INTO public.audit_events VALUES (3, 'signed_out', '22a1ffd77abd4f7d9487bf17eb9b679d', '{"session":"s-1"}', '2026-11-22T09:22:42.646717Z');


--
-- Data for Name: cases; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.cases VALUES ('case-1', 'room-0', 'P1', '1.2', '22a1ffd77abd4f7d9487bf17eb9b679d', '0.1.0', '0000000000000000000000000000000000000000000000000000000000000000', '{}', '2026-11-22T09:22:42.310038Z');
INSERT INTO public.cases VALUES ('case-2', 'room-1', 'P1', '1.2', '22a1ffd77abd4f7d9487bf17eb9b679d', '0.1.0', '0000000000000000000000000000000000000000000000000000000000000000', '{}', '2026-11-22T09:22:42.322964Z');


--
-- Data for Name: checkpoints; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.checkpoints VALUES (1, '{"key":"67ae21ae99198fd3aa26de3408aad971930dacc496e44244d8a88dadb5fb42db","previous":0,"reason":"ledger_begun","sequence":1,"sha256":"8851180c8df7e4be50e90551cd16628b2b3655ace8a8526c033998e15e9ecfc7","signed_at":"2026-11-22T09:22:42.290075Z"}', '44f2b258e6e886780caac5ae658f836b320446727f69787ea54859a162df285dcb8fb39688fa0647b8036de6543eb7f7b432c8f13d657745697d4347add4e103');
INSERT INTO public.checkpoints VALUES (20, '{"key":"67ae21ae99198fd3aa26de3408aad971930dacc496e44244d8a88dadb5fb42db","previous":1,"reason":"case_closed","sequence":20,"sha256":"106323a6859c6538234dea686a2c1172f4e695828347047aa1cb127380af9a75","signed_at":"2026-11-22T09:22:42.526352Z"}', '11f1fb4a7e6a3e81bd18c7312bb42a4ebf307542273aa3195fb3654acdbc1cc02a515364cecee8b6b08a76fce4a5c42ea2650b6f060481ab819e74e4c8207c08');
INSERT INTO public.checkpoints VALUES (29, '{"key":"67ae21ae99198fd3aa26de3408aad971930dacc496e44244d8a88dadb5fb42db","previous":20,"reason":"case_closed","sequence":29,"sha256":"817c140a15b1835734b9844b251ff35ed7b0d2ceee4ce6e71ca4d7e88bbd61eb","signed_at":"2026-11-22T09:22:42.645606Z"}', 'd15b7ae0385b19b5c19761ac5c97c2b80359e2169b3f7c5f004265f3b1ccd14a49932b2d47a44caacc107421bea942d38f6c55b072a5a49ac68457e348f88403');


--
-- Data for Name: device_files; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.device_files VALUES ('device-1', 'tcp', 'tool', '1', 'ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff', NULL, '\x6e616d65203d2031', '22a1ffd77abd4f7d9487bf17eb9b679d', 1, '2026-01-01T00:00:00.000000Z');


--
-- Data for Name: evaluations; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.evaluations VALUES ('case-1-evaluations', 'case-1', 8, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.493873Z', 'def40c5c6cf641f983b574aef1d3ef86');
INSERT INTO public.evaluations VALUES ('case-2-evaluations', 'case-2', 8, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.617236Z', 'def40c5c6cf641f983b574aef1d3ef86');


--
-- Data for Name: events; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.events VALUES ('case-1', 1, 1, 'case_opened', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.313038Z');
INSERT INTO public.events VALUES ('case-2', 1, 1, 'case_opened', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.324213Z');
INSERT INTO public.events VALUES ('case-1', 2, 2, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.401383Z');
INSERT INTO public.events VALUES ('case-1', 3, 3, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.415849Z');
INSERT INTO public.events VALUES ('case-1', 4, 4, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.435614Z');
INSERT INTO public.events VALUES ('case-1', 5, 5, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.449924Z');
INSERT INTO public.events VALUES ('case-1', 6, 6, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.463493Z');
INSERT INTO public.events VALUES ('case-1', 7, 7, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.480348Z');
INSERT INTO public.events VALUES ('case-1', 8, 8, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.493873Z');
INSERT INTO public.events VALUES ('case-1', 9, 9, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.507686Z');
INSERT INTO public.events VALUES ('case-1', 10, 10, 'case_closed', '22a1ffd77abd4f7d9487bf17eb9b679d', 'closed', '{}', '{}', '2026-11-22T09:22:42.522934Z');
INSERT INTO public.events VALUES ('case-2', 2, 2, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.535385Z');
INSERT INTO public.events VALUES ('case-2', 3, 3, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.554880Z');
INSERT INTO public.events VALUES ('case-2', 4, 4, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.559403Z');
INSERT INTO public.events VALUES ('case-2', 5, 5, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.577267Z');
INSERT INTO public.events VALUES ('case-2', 6, 6, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.594384Z');
INSERT INTO public.events VALUES ('case-2', 7, 7, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.604457Z');
INSERT INTO public.events VALUES ('case-2', 8, 8, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.617236Z');
INSERT INTO public.events VALUES ('case-2', 9, 9, 'x', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:42.631154Z');
INSERT INTO public.events VALUES ('case-2', 10, 10, 'note', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_open', '{}', '{}', '2026-11-22T09:22:42.640632Z');


--
-- Data for Name: idempotency_keys; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: image_bytes; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.image_bytes VALUES ('cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6', '\x696d6167652030');
INSERT INTO public.image_bytes VALUES ('bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b', '\x696d6167652031');
INSERT INTO public.image_bytes VALUES ('32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9', '\x696d6167652032');


--
-- Data for Name: image_purposes; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.image_purposes VALUES ('048798f55fdf4d16927fdaaff76dd315', 'case-1', 'registration', '{"joints_rad":[0.1]}', '[]', '2026-11-22T09:22:42.354368Z');
INSERT INTO public.image_purposes VALUES ('def40c5c6cf641f983b574aef1d3ef86', 'case-1', 'registration', '{"joints_rad":[0.1]}', '[]', '2026-11-22T09:22:42.375002Z');
INSERT INTO public.image_purposes VALUES ('1906711961f74b79bfff6bfa73ccf7c3', 'case-1', 'registration', '{"joints_rad":[0.1]}', '[]', '2026-11-22T09:22:42.386392Z');


--
-- Data for Name: images; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.images VALUES ('048798f55fdf4d16927fdaaff76dd315', 1, 'cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6', '1.0', '1.2', NULL, '0000000000000000000000000000000000000000000000000000000000000000', 'P1', NULL, '{"calling_ae":"CARM"}', '{"rows":96}', '2026-11-22T09:22:42.346150Z');
INSERT INTO public.images VALUES ('def40c5c6cf641f983b574aef1d3ef86', 2, 'bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b', '1.1', '1.2', '048798f55fdf4d16927fdaaff76dd315', '1111111111111111111111111111111111111111111111111111111111111111', 'P1', NULL, '{"calling_ae":"CARM"}', '{"rows":96}', '2026-11-22T09:22:42.367646Z');
INSERT INTO public.images VALUES ('1906711961f74b79bfff6bfa73ccf7c3', 3, '32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9', '1.2', '1.2', '048798f55fdf4d16927fdaaff76dd315', '2222222222222222222222222222222222222222222222222222222222222222', 'P1', NULL, '{"calling_ae":"CARM"}', '{"rows":96}', '2026-11-22T09:22:42.382592Z');


--
-- Data for Name: insertions; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.insertions VALUES ('case-1-insertions', 'case-1', 9, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.507686Z');
INSERT INTO public.insertions VALUES ('case-2-insertions', 'case-2', 9, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.631154Z');


--
-- Data for Name: leases; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: ledger; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.ledger VALUES (1, '{"action":"ledger_begun","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102401072,"payload":{"product_version":"0.1.0"},"previous":"0000000000000000000000000000000000000000000000000000000000000000","recorded_at":"2026-11-22T09:22:42.249908Z","role":null,"rows":{},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":1}', '8851180c8df7e4be50e90551cd16628b2b3655ace8a8526c033998e15e9ecfc7', '2026-11-22T09:22:42.249908Z', NULL, NULL, 'ledger_begun', NULL);
INSERT INTO public.ledger VALUES (2, '{"action":"user_added","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102452303,"payload":{"name":"anna","role":"surgeon","user_id":"22a1ffd77abd4f7d9487bf17eb9b679d"},"previous":"8851180c8df7e4be50e90551cd16628b2b3655ace8a8526c033998e15e9ecfc7","recorded_at":"2026-11-22T09:22:42.301149Z","role":null,"rows":{"audit_events":[[[1],"6428e6c6a3fbaddbf6ca4c359f1a7b8b75c5afa78b447a425b585108467cb2f5"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":2}', 'cb1619ec2be02610b220c89fd24ecaac85b1c0d6f6a343ce99f800936d602685', '2026-11-22T09:22:42.301149Z', NULL, NULL, 'user_added', NULL);
INSERT INTO public.ledger VALUES (3, '{"action":"case_opened","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":[],"attempt_id":null,"before":null,"case_id":"case-1","client":"service","monotonic_us":28102466744,"payload":{},"previous":"cb1619ec2be02610b220c89fd24ecaac85b1c0d6f6a343ce99f800936d602685","recorded_at":"2026-11-22T09:22:42.314960Z","role":"surgeon","rows":{"cases":[[["case-1"],"758b163ffef3ec76fbbdef34216fd4244d1a17214bfae97383383e77b4abd9b3"]],"events":[[["case-1",1],"30c47dde94d84e00d40b23372b509bfca37f71cde307881e1d96a9e34cb79247"]],"planned_targets":[[["case-1"],"66374241f5e006d09b930e48a6a2234cbdee3eb72169779b3c119ccba5e4f86a"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":3}', '046fb4bbe2f2c2470e0833f8adc4b523b7a0f910926402110439e1e8cbbdb9b6', '2026-11-22T09:22:42.314960Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_opened', NULL);
INSERT INTO public.ledger VALUES (4, '{"action":"case_opened","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":[],"attempt_id":null,"before":null,"case_id":"case-2","client":"service","monotonic_us":28102476894,"payload":{},"previous":"046fb4bbe2f2c2470e0833f8adc4b523b7a0f910926402110439e1e8cbbdb9b6","recorded_at":"2026-11-22T09:22:42.325365Z","role":"surgeon","rows":{"cases":[[["case-2"],"cd9a3d0aac64c0569aa7eee39ac35da5b8c885efc788eb7e25501eafebaefec1"]],"events":[[["case-2",1],"0abaaa73faf57aa9442b399944b1e282eb955774cb254e9895ed0b270dddea47"]],"planned_targets":[[["case-2"],"5abcff4f13d170442ba6e0a3381989c83696dc1add271ef6bf285dd04f69513a"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":4}', '0cb7a8a931a647347aaea49ab987038e011c8fb8fcb911283ed10fe4fce08297', '2026-11-22T09:22:42.325365Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_opened', NULL);
INSERT INTO public.ledger VALUES (5, '{"action":"signed_in","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102488954,"payload":{"session":"s-1"},"previous":"0cb7a8a931a647347aaea49ab987038e011c8fb8fcb911283ed10fe4fce08297","recorded_at":"2026-11-22T09:22:42.337332Z","role":"surgeon","rows":{"audit_events":[[[2],"334268b2a6b5c8d40c270dbf0fb6c385cf75bec78ca2acde61b9803790bc3c83"]],"device_files":[[["device-1"],"b816edb15129e9bd4d4dc939f3b258958f20d3e0f16742f09f44ee3c36e4a2f0"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":5}', 'b899624f8edd4df5e28b629f9596ff9a6b72f31db3019a233121e7966dc7fc0b', '2026-11-22T09:22:42.337332Z', NULL, '22a1ffd77abd4f7d9487bf17eb9b679d', 'signed_in', NULL);
INSERT INTO public.ledger VALUES (6, '{"action":"image_stored","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102504281,"payload":{"image_id":"048798f55fdf4d16927fdaaff76dd315","sha256":"cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6"},"previous":"b899624f8edd4df5e28b629f9596ff9a6b72f31db3019a233121e7966dc7fc0b","recorded_at":"2026-11-22T09:22:42.353128Z","role":null,"rows":{"image_bytes":[[["cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6"],"6f32b590e03e5f95f7466d7d31d6f8771fd362417b52041224fc88c1bc82cb45"]],"images":[[["048798f55fdf4d16927fdaaff76dd315"],"235788d0dbc9597470a3a66072942109f718dd32ae201118fc2ff2b50fdb70b8"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":6}', '4d95df4cc3b0ceb089fa323c57e4da4afcca49125c25c145f864b6dd8f5c1970', '2026-11-22T09:22:42.353128Z', NULL, NULL, 'image_stored', NULL);
INSERT INTO public.ledger VALUES (7, '{"action":"recorded","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102507469,"payload":{"image_id":"048798f55fdf4d16927fdaaff76dd315","purpose":"registration"},"previous":"4d95df4cc3b0ceb089fa323c57e4da4afcca49125c25c145f864b6dd8f5c1970","recorded_at":"2026-11-22T09:22:42.356320Z","role":null,"rows":{"image_purposes":[[["048798f55fdf4d16927fdaaff76dd315"],"9050c049244178256f05e80b3477a82527546ea6611f8ad359f31f699b0bc191"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":7}', '29b2117ddb173b7c945bb342690c69c849f5115d9796981eb025562aa5df1d09', '2026-11-22T09:22:42.356320Z', NULL, NULL, 'recorded', NULL);
INSERT INTO public.ledger VALUES (8, '{"action":"image_stored","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102525094,"payload":{"image_id":"def40c5c6cf641f983b574aef1d3ef86","sha256":"bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b"},"previous":"29b2117ddb173b7c945bb342690c69c849f5115d9796981eb025562aa5df1d09","recorded_at":"2026-11-22T09:22:42.373938Z","role":null,"rows":{"image_bytes":[[["bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b"],"4335f878bb8196cfb933c23eb54b9e69f85fbc2205907cb07f4e20e4115a1792"]],"images":[[["def40c5c6cf641f983b574aef1d3ef86"],"db61ea324ddbd704fe4b20e6109e6339225074114a6b40f1a83f7f1fa92e7fae"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":8}', 'd53302b771ff3d218f82a42af464b1a606dedf0bf8e8894816aca75c1c323b7b', '2026-11-22T09:22:42.373938Z', NULL, NULL, 'image_stored', NULL);
INSERT INTO public.ledger VALUES (9, '{"action":"recorded","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102527166,"payload":{"image_id":"def40c5c6cf641f983b574aef1d3ef86","purpose":"registration"},"previous":"d53302b771ff3d218f82a42af464b1a606dedf0bf8e8894816aca75c1c323b7b","recorded_at":"2026-11-22T09:22:42.376019Z","role":null,"rows":{"image_purposes":[[["def40c5c6cf641f983b574aef1d3ef86"],"020f23509e5514a6e39563648e7bb68c699afc67f77d7e052a18b69942083f0c"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":9}', '26ea934b2d6815803a8d2abde95591e6b6f0784f5b16fa27c69ce496d0b381f4', '2026-11-22T09:22:42.376019Z', NULL, NULL, 'recorded', NULL);
INSERT INTO public.ledger VALUES (10, '{"action":"image_stored","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102534842,"payload":{"image_id":"1906711961f74b79bfff6bfa73ccf7c3","sha256":"32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9"},"previous":"26ea934b2d6815803a8d2abde95591e6b6f0784f5b16fa27c69ce496d0b381f4","recorded_at":"2026-11-22T09:22:42.383695Z","role":null,"rows":{"image_bytes":[[["32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9"],"0a43423277303a1e348c4dc2cd31208bd735a4e1c0766f499d66a883b0f17a7e"]],"images":[[["1906711961f74b79bfff6bfa73ccf7c3"],"2bdaba288c2dbb0658125f4ccdfecabe2b019b9abb0465ea969190ec912cc4a2"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":10}', 'c362fcc1ded215ac1dc8d60604a1983a8a7ec63a99022f9d50b6be5304808cba', '2026-11-22T09:22:42.383695Z', NULL, NULL, 'image_stored', NULL);
INSERT INTO public.ledger VALUES (11, '{"action":"recorded","actor":null,"actor_name":null,"after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102538717,"payload":{"image_id":"1906711961f74b79bfff6bfa73ccf7c3","purpose":"registration"},"previous":"c362fcc1ded215ac1dc8d60604a1983a8a7ec63a99022f9d50b6be5304808cba","recorded_at":"2026-11-22T09:22:42.387569Z","role":null,"rows":{"image_purposes":[[["1906711961f74b79bfff6bfa73ccf7c3"],"e1e2a0624c71c8b845536e77140dbe6c522fa87d527c035e0bbbdd182403f8bd"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":11}', '48b26d146c6c3967ef211683ed9b3a9e2d9111be644e4fc9c23d651dfea87dcd', '2026-11-22T09:22:42.387569Z', NULL, NULL, 'recorded', NULL);
INSERT INTO public.ledger VALUES (12, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-registrations"],"attempt_id":1,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102560221,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"48b26d146c6c3967ef211683ed9b3a9e2d9111be644e4fc9c23d651dfea87dcd","recorded_at":"2026-11-22T09:22:42.405277Z","role":"surgeon","rows":{"attempts":[[[1],"93aebfc57bb6821afc0e1070977984c0549c5eb6d1b43aadddc0a2f983d42213"]],"events":[[["case-1",2],"937bcd05d85fe4224f2b3ec9c7ef6d398261a07cd0e796c37fdb363a2361c7bd"]],"registrations":[[["case-1-registrations"],"496f12973b98ac4ae50ca927fb0642584a34816e088496dcbf88d4d37d64d313"]],"verdicts":[[[1],"b5e5c6d763f8b67ae982932eb32f873729012d7553a6176837792a2f8586918c"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":12}', '6c7c9693735924e465ad25b9a839414efc775ba62364679c61b5f7ec1aad2058', '2026-11-22T09:22:42.405277Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 1);
INSERT INTO public.ledger VALUES (13, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-targets"],"attempt_id":2,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102575132,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"6c7c9693735924e465ad25b9a839414efc775ba62364679c61b5f7ec1aad2058","recorded_at":"2026-11-22T09:22:42.423602Z","role":"surgeon","rows":{"attempts":[[[2],"5756e707712fd728156eb98279da9be8d27a42e78fe09fca190aa821540e005a"]],"events":[[["case-1",3],"1460f3d7624b7ee4bb5f71d5f8b058ceb40399df09d127e4ebf13c886dc41162"]],"targets":[[["case-1-targets"],"d5cc2886e1de634937541f90fa715c14dabffd8a8b52a60cc9a095c715da5706"]],"verdicts":[[[2],"e1501b1246d4c3a28c0b624af11a31ce476bc116caf4c99ba701f2183b68ca20"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":13}', 'a8b4deefa432d0eb7c6b4a2cd2c360c60b2f7316de063d2fe710ff4847a4f505', '2026-11-22T09:22:42.423602Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 2);
INSERT INTO public.ledger VALUES (14, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-plans"],"attempt_id":3,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102593508,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"a8b4deefa432d0eb7c6b4a2cd2c360c60b2f7316de063d2fe710ff4847a4f505","recorded_at":"2026-11-22T09:22:42.441821Z","role":"surgeon","rows":{"attempts":[[[3],"bed4136738f4fb91aa79c2e3ac0935b36ede8d02884ce973501a0f336ad5b6ac"]],"events":[[["case-1",4],"8a08740f94175f7da21f5b5d631080298adf2e88365c32ebf8d3a2cc5c075d31"]],"plans":[[["case-1-plans"],"c748c8149a26ae8e5e4660aaafb9b3202ae6728cf82f3b4a4ca3b40ec72aba5b"]],"verdicts":[[[3],"b475e50055fdb385de8f003a4ce8a1695bc3e4cfcf9d0630a3daaa6461eb11aa"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":14}', '045cab5890cca0f109a725d63ce3900e22ea0e12ed01b6deff5e441d9b8ff008', '2026-11-22T09:22:42.441821Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 3);
INSERT INTO public.ledger VALUES (15, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-permits"],"attempt_id":4,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102607115,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"045cab5890cca0f109a725d63ce3900e22ea0e12ed01b6deff5e441d9b8ff008","recorded_at":"2026-11-22T09:22:42.455533Z","role":"surgeon","rows":{"attempts":[[[4],"834603faf70b9b91e1be4ddf125135960721a2e168c5dab44c6f4b4462ea3202"]],"events":[[["case-1",5],"56fe5ee570f971045e7aefb01072f94de6d856534b35a6b48fffaa9368b0ddbf"]],"permits":[[["case-1-permits"],"9a6514de5e69ec5f16f06b59d54b7fdc76e913a311e15b3da056c8803de6941a"]],"verdicts":[[[4],"81a0dbdd87b3e59cb46b1e9d1306741d74a27c14f08c7df465ed0a47b018888f"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":15}', 'd7a92296cf798e273f42a0e51e478b27b4f459aa7d07d459878ff9430d2c159f', '2026-11-22T09:22:42.455533Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 4);
INSERT INTO public.ledger VALUES (16, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-permits"],"attempt_id":5,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102620822,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"d7a92296cf798e273f42a0e51e478b27b4f459aa7d07d459878ff9430d2c159f","recorded_at":"2026-11-22T09:22:42.469226Z","role":"surgeon","rows":{"attempts":[[[5],"42c6af803649ab6be4399af264c212f7c8ddf2641fd6aa9094c54e25f86ec345"]],"events":[[["case-1",6],"8d07e15c9101cf74f53750e0f0c0edf21bcd03a314048c62b12caf12e3b6dc4a"]],"permit_uses":[[["case-1-permits"],"7e21cb062936021b04983ad915cd58a33e484178e6762ef699c4c1556a1e4a8a"]],"verdicts":[[[5],"bb36cd363b809519407e5e052c40f4ea5ac339b1414690488c9490af341b164a"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":16}', 'ee534e670250223e29e8659263dc3ef3d524da41a77b08520dd55e6e88859850', '2026-11-22T09:22:42.469226Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 5);
INSERT INTO public.ledger VALUES (17, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-motions"],"attempt_id":6,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102640375,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"ee534e670250223e29e8659263dc3ef3d524da41a77b08520dd55e6e88859850","recorded_at":"2026-11-22T09:22:42.485106Z","role":"surgeon","rows":{"attempts":[[[6],"4cb8e2c155f5b9e923f233aaa5a29b825c7e61b5d55d299c09fe53be4475e8c5"]],"events":[[["case-1",7],"8214d2483721325a958b3041ae25d7426101757b5306afe3496bec3d70a08422"]],"motions":[[["case-1-motions"],"2b080ebcb5618fbe288984f7c75e12fcd76fef08a3b22e8318764bda1a6344cd"]],"verdicts":[[[6],"96c456670eb3d211f94a9b42c9ed427d281ed687b0433ad62bb5d596f3ee2176"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":17}', '10212bd0e7b81a6ccb2f1f1cbbb98ce31902e835357b102fe4efd2617171844d', '2026-11-22T09:22:42.485106Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 6);
INSERT INTO public.ledger VALUES (18, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-evaluations"],"attempt_id":7,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102651562,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"10212bd0e7b81a6ccb2f1f1cbbb98ce31902e835357b102fe4efd2617171844d","recorded_at":"2026-11-22T09:22:42.500045Z","role":"surgeon","rows":{"attempts":[[[7],"aececab60512256842a95d46b1eccbb71fae02e789052b828f781aef11010272"]],"evaluations":[[["case-1-evaluations"],"dd38314b9afe49deaf1057b26dac01c648b3b28b25970fa1af915a0413080572"]],"events":[[["case-1",8],"8e45f997bcf737735ab79c3370ef14a812dd150757f8337a30750dfbe3a9e875"]],"verdicts":[[[7],"a44d4512190dc3d3a0bd128322c35b222a86b26c28127d3e6d8ea35fe235c4dd"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":18}', 'fe2d0fc55bc0db3a9d6fd84d2194afa4f5321d3e53f5c41993c66c11e44a991d', '2026-11-22T09:22:42.500045Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 7);
INSERT INTO public.ledger VALUES (19, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-1-insertions"],"attempt_id":8,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102664741,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"fe2d0fc55bc0db3a9d6fd84d2194afa4f5321d3e53f5c41993c66c11e44a991d","recorded_at":"2026-11-22T09:22:42.513190Z","role":"surgeon","rows":{"attempts":[[[8],"f99e1acd31bdc156d4cec9c1325b58491f7c2426b1837e9e4f04dfbc30fc4abc"]],"events":[[["case-1",9],"2fa9aae9cc89ab72103a66af1240e53cb26b1ae7e0ee4eba77567cfa71361bc9"]],"insertions":[[["case-1-insertions"],"1dcc09e23c9a42d2c0dd57d412376676241a4fa7e7e1ee73f3e0c1561c2ce311"]],"verdicts":[[[8],"c9b47474b852d5919ae9038ad1b03dbf60fe4dcf0691b3c58229455073ba427f"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":19}', '1cbf9dea2753ccba377e2d09d0b93a1d75133aa1d82695247c3462bc5536b094', '2026-11-22T09:22:42.513190Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 8);
INSERT INTO public.ledger VALUES (20, '{"action":"case_closed","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"closed","artefacts":[],"attempt_id":9,"before":"case_open","case_id":"case-1","client":"service","monotonic_us":28102675144,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"1cbf9dea2753ccba377e2d09d0b93a1d75133aa1d82695247c3462bc5536b094","recorded_at":"2026-11-22T09:22:42.523746Z","role":"surgeon","rows":{"attempts":[[[9],"9281c1e14df06ec3e24737a710b02ef53b27f0155b46ef4284c7bcf44b0dbcb2"]],"events":[[["case-1",10],"45366117b4da025a83b84690facb16089eb81d9a1d2c87b8c9697a970d4df402"]],"verdicts":[[[9],"829ad2b74b2479821825bdb49683e6cc7d89fc944580907bdf6eb1acc863c47f"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":20}', '106323a6859c6538234dea686a2c1172f4e695828347047aa1cb127380af9a75', '2026-11-22T09:22:42.523746Z', 'case-1', '22a1ffd77abd4f7d9487bf17eb9b679d', 'case_closed', 9);
INSERT INTO public.ledger VALUES (21, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-registrations"],"attempt_id":10,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102688836,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"106323a6859c6538234dea686a2c1172f4e695828347047aa1cb127380af9a75","recorded_at":"2026-11-22T09:22:42.537385Z","role":"surgeon","rows":{"attempts":[[[10],"47473b260686879436028ef851c93b3f3bbda2e1558cc375e2f243141bbfa92b"]],"events":[[["case-2",2],"cf8d2e2418ce3aa9d23d4e9db104e1560c665a084ed9a32a0a450ae1945065e6"]],"registrations":[[["case-2-registrations"],"f3c4dc236fc633de17c52cbc83451975f3fa7a1a46fff41f3da4fd644c0cdf4b"]],"verdicts":[[[10],"db0c4141cb5b294b087b59d4a3f17f176325eb0ec4f2bf103dfeded11dedb613"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":21}', 'c06209ef0eecaac5f24d791842db6d9b0d0abea9628853baf9d7bc4943cf5c84', '2026-11-22T09:22:42.537385Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 10);
INSERT INTO public.ledger VALUES (22, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-targets"],"attempt_id":11,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102707805,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"c06209ef0eecaac5f24d791842db6d9b0d0abea9628853baf9d7bc4943cf5c84","recorded_at":"2026-11-22T09:22:42.556372Z","role":"surgeon","rows":{"attempts":[[[11],"7b2533e79ed24335cbd90c8f0139607161f09b00c30cf614728280af823ba716"]],"events":[[["case-2",3],"8f130316fdd3ed82db4062e8e6bc6a9a7131f9e269ca2ee9c6da1c9e28495445"]],"targets":[[["case-2-targets"],"a80d31a7366c44f8bbcc1a28b8c824b2c9c84caabf87a862f6e3f401bc3fd3cb"]],"verdicts":[[[11],"eb39473675953d3d00645ea60806ac1075fb07ab3463d60e183645a253e07adb"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":22}', '70d2a97490bcdeb2f762b84bf9d5ef505b412339441fdf7a441c8a314caa3581', '2026-11-22T09:22:42.556372Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 11);
INSERT INTO public.ledger VALUES (23, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-plans"],"attempt_id":12,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102717046,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"70d2a97490bcdeb2f762b84bf9d5ef505b412339441fdf7a441c8a314caa3581","recorded_at":"2026-11-22T09:22:42.565601Z","role":"surgeon","rows":{"attempts":[[[12],"acbb9629c49f05658de17588d94d3456df9ef94fcf3343659c7c80d1563cfe67"]],"events":[[["case-2",4],"0f6a04269ab656474a22d0e4aefee75b09cde4b8abc0efae98de89189b975eac"]],"plans":[[["case-2-plans"],"f02357457df6fc44deb0b5c240a8804485878ef071d0a93b3254992a38097852"]],"verdicts":[[[12],"cdd80de49edc2a4481bcce19cec8863268d2107e27cb4d4f863dfc9773fdaeb3"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":23}', 'c5b61991348bffd3eae0564868c11560380171c4568c7cebd77640e2e3000a92', '2026-11-22T09:22:42.565601Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 12);
INSERT INTO public.ledger VALUES (24, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-permits"],"attempt_id":13,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102736757,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"c5b61991348bffd3eae0564868c11560380171c4568c7cebd77640e2e3000a92","recorded_at":"2026-11-22T09:22:42.585229Z","role":"surgeon","rows":{"attempts":[[[13],"a0ac8da18238584343f3f0436f8db1ae89c0d03921eb08d3887a7cf6c9853c97"]],"events":[[["case-2",5],"e46a94f12fd1233da4c194f145f4a3bbace54f41467ab1e656e94e37c860efd7"]],"permits":[[["case-2-permits"],"7fdc7ab9671fe340de86b3469c6b5284ee9a48ad4c35d46631119c4f35ec5235"]],"verdicts":[[[13],"82a55c4bdb8c3d187ee52f074834f3d5f9392dee153dae768862aa6b63b1fd56"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":24}', '948e5659823e2eaeaffac3d259d96184781a186f3f06adcbfd9bce1afa95b59f', '2026-11-22T09:22:42.585229Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 13);
INSERT INTO public.ledger VALUES (25, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-permits"],"attempt_id":14,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102753079,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"948e5659823e2eaeaffac3d259d96184781a186f3f06adcbfd9bce1afa95b59f","recorded_at":"2026-11-22T09:22:42.601617Z","role":"surgeon","rows":{"attempts":[[[14],"d1d38b2dfffeb2c5580a1f9ca81a86ee906028ba7a150fe161afc01854b6ff96"]],"events":[[["case-2",6],"5f15d9bcc8cd94c2f9576f15e7b7c80dcf2ff81057e5d1767d6852a2e125e437"]],"permit_uses":[[["case-2-permits"],"56c29d947a498f20085bff1e3d883af35700918586c9ac61697aa5f575c2a6d2"]],"verdicts":[[[14],"5227760211f767f108427f707e04e9df76db6ee28371bffefb30c8a611b8f459"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":25}', '0ee41ae99420f36ab78da7456bb07074ff7f29e6bea6912691ed5058f63b0732', '2026-11-22T09:22:42.601617Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 14);
INSERT INTO public.ledger VALUES (26, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-motions"],"attempt_id":15,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102760716,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"0ee41ae99420f36ab78da7456bb07074ff7f29e6bea6912691ed5058f63b0732","recorded_at":"2026-11-22T09:22:42.609158Z","role":"surgeon","rows":{"attempts":[[[15],"b9b6e5a571858125fbd34877817d902bfefbc16150786d97fdad228454eda664"]],"events":[[["case-2",7],"165a753a8d22c476fdb271e73d11ca48f3d89b8ed2d7f0217193b757807da3b5"]],"motions":[[["case-2-motions"],"49ac405b967ccefac3a04e4c82209501b59da0f332f51ffc40070deda29cd582"]],"verdicts":[[[15],"46c1db973f72a90f45ab4680d9605fee71116e091fb129581b0c9a012a349a87"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":26}', '0febf73197aad960e8112226a9f30f4ee8a6d246a43952ce03b14850b713185b', '2026-11-22T09:22:42.609158Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 15);
INSERT INTO public.ledger VALUES (27, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-evaluations"],"attempt_id":16,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102776787,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"0febf73197aad960e8112226a9f30f4ee8a6d246a43952ce03b14850b713185b","recorded_at":"2026-11-22T09:22:42.625222Z","role":"surgeon","rows":{"attempts":[[[16],"77130e7f68d41a478f617f89208af0a373fe4e60de4f2629dba0ee0885822445"]],"evaluations":[[["case-2-evaluations"],"691614242ba35a018d46aa253fcc124f0453bf8273188d7008f000e4517f0b7e"]],"events":[[["case-2",8],"c4db7a14b63c95b118874ff372668750e2d098c84efaf002c74a0e5aef497fa4"]],"verdicts":[[[16],"a9340bebe2990e87a12b042f5af7ea62f3804801b41fef94316743a77583f6f3"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":27}', '213f07086730f87d88ee7e7ffc3b2c80f1a3fb835f6638c342fbc42a7530f1ee', '2026-11-22T09:22:42.625222Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 16);
INSERT INTO public.ledger VALUES (28, '{"action":"x","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":["case-2-insertions"],"attempt_id":17,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102789209,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"213f07086730f87d88ee7e7ffc3b2c80f1a3fb835f6638c342fbc42a7530f1ee","recorded_at":"2026-11-22T09:22:42.637739Z","role":"surgeon","rows":{"attempts":[[[17],"40e9b33f9dc3a2dcc88631085d1faed406d3b3f4f63a203685b9687b0f5c1428"]],"events":[[["case-2",9],"e3b4b9713e5287766b9bf0ad3a01282ca9c4285f17ff41e715d4fd2c59e3bbaa"]],"insertions":[[["case-2-insertions"],"3c851253e2dc1bdd0a63049ecbda4d6b3ab8451e56e8260c5a8e3cd0ab3784c0"]],"verdicts":[[[17],"090d70826e30fabac2e55c719a58be9fd2c04d6ddb2f4e22918efe189f9f97a4"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":28}', '627d198aeeaa2e1ba45a2276cec312bf29fa0f5e8592134179f1f3c5bc011413', '2026-11-22T09:22:42.637739Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'x', 17);
INSERT INTO public.ledger VALUES (29, '{"action":"note","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":"case_open","artefacts":[],"attempt_id":18,"before":"case_open","case_id":"case-2","client":"service","monotonic_us":28102792902,"payload":{"accepted":true,"code":"taken","message":"","refused_by":["guide_empty"]},"previous":"627d198aeeaa2e1ba45a2276cec312bf29fa0f5e8592134179f1f3c5bc011413","recorded_at":"2026-11-22T09:22:42.641482Z","role":"surgeon","rows":{"attempts":[[[18],"7a0621ff0a102cbfad47c83ba7f8ae48302cc080cc4c27fefd355f725cb29090"]],"events":[[["case-2",10],"5fec435b79b1f4a22219189503d5b8fd1e314d64af33dd9fc6c38a09f4d92fdc"]],"verdicts":[[[18],"474f347bf220227f8c0252e9e6b3c5186b12cd94e4e53e2dd5c1d494f5fd6816"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":29}', '817c140a15b1835734b9844b251ff35ed7b0d2ceee4ce6e71ca4d7e88bbd61eb', '2026-11-22T09:22:42.641482Z', 'case-2', '22a1ffd77abd4f7d9487bf17eb9b679d', 'note', 18);
INSERT INTO public.ledger VALUES (30, '{"action":"signed_out","actor":"22a1ffd77abd4f7d9487bf17eb9b679d","actor_name":"anna","after":null,"artefacts":[],"attempt_id":null,"before":null,"case_id":null,"client":"service","monotonic_us":28102804622,"payload":{"session":"s-1"},"previous":"817c140a15b1835734b9844b251ff35ed7b0d2ceee4ce6e71ca4d7e88bbd61eb","recorded_at":"2026-11-22T09:22:42.653064Z","role":"surgeon","rows":{"audit_events":[[[3],"f434964ef0391bb4c8d731ca9119f6ae02b301b20dde18d3bc20d08e7b608d7f"]]},"run":"d417dbaf988d4735a8cddf09057038ac","sequence":30}', '2c5528226a08d7d01cabacd113f36265b2bcf4d6bc20c02f4e5e12dec7455cce', '2026-11-22T09:22:42.653064Z', NULL, '22a1ffd77abd4f7d9487bf17eb9b679d', 'signed_out', NULL);


--
-- Data for Name: lock_outs; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: motions; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.motions VALUES ('case-1-motions', 'case-1', 7, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.480348Z', '\x000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f202122232425262728292a2b2c2d2e2f303132333435363738393a3b3c3d3e3f');
INSERT INTO public.motions VALUES ('case-2-motions', 'case-2', 7, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.604457Z', '\x000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f202122232425262728292a2b2c2d2e2f303132333435363738393a3b3c3d3e3f');


--
-- Data for Name: permit_uses; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.permit_uses VALUES ('case-1-permits', 'case-1', 6, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.463493Z');
INSERT INTO public.permit_uses VALUES ('case-2-permits', 'case-2', 6, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.594384Z');


--
-- Data for Name: permits; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.permits VALUES ('case-1-permits', 'case-1', 5, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.449924Z', '22a1ffd77abd4f7d9487bf17eb9b679d');
INSERT INTO public.permits VALUES ('case-2-permits', 'case-2', 5, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.577267Z', '22a1ffd77abd4f7d9487bf17eb9b679d');


--
-- Data for Name: planned_targets; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.planned_targets VALUES ('case-1', 'L3', '{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO public.planned_targets VALUES ('case-1', 'L4', '{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO public.planned_targets VALUES ('case-2', 'L3', '{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');
INSERT INTO public.planned_targets VALUES ('case-2', 'L4', '{"entry_mm":[0.0,0.0,0.1],"target_mm":[0.0,40.0,0.0]}');


--
-- Data for Name: plans; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.plans VALUES ('case-1-plans', 'case-1', 4, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.435614Z');
INSERT INTO public.plans VALUES ('case-2-plans', 'case-2', 4, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.559403Z');


--
-- Data for Name: registrations; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.registrations VALUES ('case-1-registrations', 'case-1', 2, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.401383Z', '048798f55fdf4d16927fdaaff76dd315');
INSERT INTO public.registrations VALUES ('case-2-registrations', 'case-2', 2, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.535385Z', '048798f55fdf4d16927fdaaff76dd315');


--
-- Data for Name: room_claims; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: sessions; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: targets; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.targets VALUES ('case-1-targets', 'case-1', 3, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.415849Z');
INSERT INTO public.targets VALUES ('case-2-targets', 'case-2', 3, '[]', '{"value":0.1234567}', '2026-11-22T09:22:42.554880Z');


--
-- Data for Name: users; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.users VALUES ('22a1ffd77abd4f7d9487bf17eb9b679d', 'anna', 'surgeon', '$argon2id$v=19$m=8,t=1,p=1$5ExPHrl+f7Rmhm49//UN/Q$uwt+gi51m6O4H8a0MrW/PsHQJuwDyZyCthdwV3KRbkY', '$argon2id$v=19$m=8,t=1,p=1$K3X1iFG8fwc3+U7bZ9iwzQ$bDfuTfPJd4ThziSU9gwwjf3tYuCbyTm2zRkp5MHSojk', '2026-11-22T09:22:42.292637Z', NULL);


--
-- Data for Name: verdicts; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.verdicts VALUES (1, 1, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (2, 1, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (3, 2, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (4, 2, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (5, 3, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (6, 3, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (7, 4, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (8, 4, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (9, 5, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (10, 5, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (11, 6, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (12, 6, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (13, 7, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (14, 7, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (15, 8, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (16, 8, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (17, 9, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (18, 9, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (19, 10, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (20, 10, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (21, 11, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (22, 11, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (23, 12, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (24, 12, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (25, 13, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (26, 13, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (27, 14, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (28, 14, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (29, 15, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (30, 15, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (31, 16, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (32, 16, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (33, 17, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (34, 17, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');
INSERT INTO public.verdicts VALUES (35, 18, 'image_age', 'H03', true, '12.3456789', '1800.0', 's', '');
INSERT INTO public.verdicts VALUES (36, 18, 'guide_empty', 'H35', false, '"wire"', '"empty"', '', 'the guide is not stated to be empty');


--
-- Name: attempts_id_seq; Type: SEQUENCE SET; Schema: public; Owner: -
--

SELECT pg_catalog.setval('public.attempts_id_seq', 18, true);


--
-- Name: audit_events_id_seq; Type: SEQUENCE SET; Schema: public; Owner: -
--

SELECT pg_catalog.setval('public.audit_events_id_seq', 3, true);


--
-- Name: verdicts_id_seq; Type: SEQUENCE SET; Schema: public; Owner: -
--

SELECT pg_catalog.setval('public.verdicts_id_seq', 36, true);


--
-- Name: alembic_version alembic_version_pkc; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.alembic_version
    ADD CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num);


--
-- Name: attempts pk_attempts; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.attempts
    ADD CONSTRAINT pk_attempts PRIMARY KEY (id);


--
-- Name: audit_events pk_audit_events; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.audit_events
    ADD CONSTRAINT pk_audit_events PRIMARY KEY (id);


--
-- Name: cases pk_cases; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.cases
    ADD CONSTRAINT pk_cases PRIMARY KEY (id);


--
-- Name: checkpoints pk_checkpoints; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.checkpoints
    ADD CONSTRAINT pk_checkpoints PRIMARY KEY (sequence);


--
-- Name: device_files pk_device_files; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.device_files
    ADD CONSTRAINT pk_device_files PRIMARY KEY (id);


--
-- Name: evaluations pk_evaluations; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.evaluations
    ADD CONSTRAINT pk_evaluations PRIMARY KEY (id);


--
-- Name: events pk_events; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.events
    ADD CONSTRAINT pk_events PRIMARY KEY (case_id, sequence);


--
-- Name: idempotency_keys pk_idempotency_keys; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.idempotency_keys
    ADD CONSTRAINT pk_idempotency_keys PRIMARY KEY (user_id, key);


--
-- Name: image_bytes pk_image_bytes; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.image_bytes
    ADD CONSTRAINT pk_image_bytes PRIMARY KEY (sha256);


--
-- Name: image_purposes pk_image_purposes; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.image_purposes
    ADD CONSTRAINT pk_image_purposes PRIMARY KEY (image_id);


--
-- Name: images pk_images; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.images
    ADD CONSTRAINT pk_images PRIMARY KEY (id);


--
-- Name: insertions pk_insertions; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.insertions
    ADD CONSTRAINT pk_insertions PRIMARY KEY (id);


--
-- Name: leases pk_leases; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.leases
    ADD CONSTRAINT pk_leases PRIMARY KEY (case_id);


--
-- Name: ledger pk_ledger; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.ledger
    ADD CONSTRAINT pk_ledger PRIMARY KEY (sequence);


--
-- Name: lock_outs pk_lock_outs; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.lock_outs
    ADD CONSTRAINT pk_lock_outs PRIMARY KEY (subject);


--
-- Name: motions pk_motions; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.motions
    ADD CONSTRAINT pk_motions PRIMARY KEY (id);


--
-- Name: permit_uses pk_permit_uses; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.permit_uses
    ADD CONSTRAINT pk_permit_uses PRIMARY KEY (id);


--
-- Name: permits pk_permits; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.permits
    ADD CONSTRAINT pk_permits PRIMARY KEY (id);


--
-- Name: planned_targets pk_planned_targets; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.planned_targets
    ADD CONSTRAINT pk_planned_targets PRIMARY KEY (case_id, name);


--
-- Name: plans pk_plans; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.plans
    ADD CONSTRAINT pk_plans PRIMARY KEY (id);


--
-- Name: registrations pk_registrations; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.registrations
    ADD CONSTRAINT pk_registrations PRIMARY KEY (id);


--
-- Name: room_claims pk_room_claims; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.room_claims
    ADD CONSTRAINT pk_room_claims PRIMARY KEY (room);


--
-- Name: sessions pk_sessions; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.sessions
    ADD CONSTRAINT pk_sessions PRIMARY KEY (id);


--
-- Name: targets pk_targets; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.targets
    ADD CONSTRAINT pk_targets PRIMARY KEY (id);


--
-- Name: users pk_users; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.users
    ADD CONSTRAINT pk_users PRIMARY KEY (id);


--
-- Name: verdicts pk_verdicts; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.verdicts
    ADD CONSTRAINT pk_verdicts PRIMARY KEY (id);


--
-- Name: device_files uq_device_files_kind_name_version; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.device_files
    ADD CONSTRAINT uq_device_files_kind_name_version UNIQUE (kind, name, version);


--
-- Name: device_files uq_device_files_position; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.device_files
    ADD CONSTRAINT uq_device_files_position UNIQUE ("position");


--
-- Name: images uq_images_position; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.images
    ADD CONSTRAINT uq_images_position UNIQUE ("position");


--
-- Name: ledger uq_ledger_attempt_id; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.ledger
    ADD CONSTRAINT uq_ledger_attempt_id UNIQUE (attempt_id);


--
-- Name: sessions uq_sessions_token_sha256; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.sessions
    ADD CONSTRAINT uq_sessions_token_sha256 UNIQUE (token_sha256);


--
-- Name: users uq_users_name; Type: CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.users
    ADD CONSTRAINT uq_users_name UNIQUE (name);


--
-- Name: ix_attempts_case_id; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_attempts_case_id ON public.attempts USING btree (case_id);


--
-- Name: ix_image_purposes_case_id; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_image_purposes_case_id ON public.image_purposes USING btree (case_id);


--
-- Name: ix_images_pixel_sha256; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_images_pixel_sha256 ON public.images USING btree (pixel_sha256);


--
-- Name: ix_images_sha256; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_images_sha256 ON public.images USING btree (sha256);


--
-- Name: ix_images_sop_uid; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_images_sop_uid ON public.images USING btree (sop_uid);


--
-- Name: ix_ledger_action_sequence; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_ledger_action_sequence ON public.ledger USING btree (action, sequence);


--
-- Name: ix_ledger_actor_sequence; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_ledger_actor_sequence ON public.ledger USING btree (actor, sequence);


--
-- Name: ix_ledger_case_id_sequence; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_ledger_case_id_sequence ON public.ledger USING btree (case_id, sequence);


--
-- Name: ix_ledger_reached_at; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_ledger_reached_at ON public.ledger USING btree (reached_at);


--
-- Name: ix_verdicts_attempt_id; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_verdicts_attempt_id ON public.verdicts USING btree (attempt_id);


--
-- Name: ix_verdicts_code_attempt_id; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_verdicts_code_attempt_id ON public.verdicts USING btree (code, attempt_id);


--
-- Name: ix_verdicts_hazard_attempt_id; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_verdicts_hazard_attempt_id ON public.verdicts USING btree (hazard, attempt_id);


--
-- Name: attempts attempts_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER attempts_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.attempts FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: audit_events audit_events_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER audit_events_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.audit_events FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: cases cases_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER cases_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.cases FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: checkpoints checkpoints_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER checkpoints_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.checkpoints FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: device_files device_files_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER device_files_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.device_files FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: evaluations evaluations_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER evaluations_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.evaluations FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: events events_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER events_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.events FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: image_bytes image_bytes_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER image_bytes_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.image_bytes FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: image_purposes image_purposes_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER image_purposes_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.image_purposes FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: images images_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER images_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.images FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: insertions insertions_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER insertions_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.insertions FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: ledger ledger_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER ledger_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.ledger FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: motions motions_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER motions_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.motions FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: permit_uses permit_uses_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER permit_uses_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.permit_uses FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: permits permits_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER permits_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.permits FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: planned_targets planned_targets_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER planned_targets_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.planned_targets FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: plans plans_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER plans_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.plans FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: registrations registrations_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER registrations_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.registrations FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: targets targets_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER targets_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.targets FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: verdicts verdicts_append_only; Type: TRIGGER; Schema: public; Owner: -
--

CREATE TRIGGER verdicts_append_only BEFORE DELETE OR UPDATE OR TRUNCATE ON public.verdicts FOR EACH STATEMENT EXECUTE FUNCTION public.refuse_change();


--
-- Name: attempts fk_attempts_case_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.attempts
    ADD CONSTRAINT fk_attempts_case_id FOREIGN KEY (case_id) REFERENCES public.cases(id);


--
-- Name: cases fk_cases_opened_by; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.cases
    ADD CONSTRAINT fk_cases_opened_by FOREIGN KEY (opened_by) REFERENCES public.users(id);


--
-- Name: checkpoints fk_checkpoints_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.checkpoints
    ADD CONSTRAINT fk_checkpoints_sequence FOREIGN KEY (sequence) REFERENCES public.ledger(sequence);


--
-- Name: device_files fk_device_files_uploaded_by; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.device_files
    ADD CONSTRAINT fk_device_files_uploaded_by FOREIGN KEY (uploaded_by) REFERENCES public.users(id);


--
-- Name: evaluations fk_evaluations_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.evaluations
    ADD CONSTRAINT fk_evaluations_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: evaluations fk_evaluations_image_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.evaluations
    ADD CONSTRAINT fk_evaluations_image_id FOREIGN KEY (image_id) REFERENCES public.images(id);


--
-- Name: events fk_events_case_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.events
    ADD CONSTRAINT fk_events_case_id FOREIGN KEY (case_id) REFERENCES public.cases(id);


--
-- Name: events fk_events_user_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.events
    ADD CONSTRAINT fk_events_user_id FOREIGN KEY (user_id) REFERENCES public.users(id);


--
-- Name: image_purposes fk_image_purposes_case_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.image_purposes
    ADD CONSTRAINT fk_image_purposes_case_id FOREIGN KEY (case_id) REFERENCES public.cases(id);


--
-- Name: image_purposes fk_image_purposes_image_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.image_purposes
    ADD CONSTRAINT fk_image_purposes_image_id FOREIGN KEY (image_id) REFERENCES public.images(id);


--
-- Name: images fk_images_duplicate_of; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.images
    ADD CONSTRAINT fk_images_duplicate_of FOREIGN KEY (duplicate_of) REFERENCES public.images(id);


--
-- Name: images fk_images_sha256; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.images
    ADD CONSTRAINT fk_images_sha256 FOREIGN KEY (sha256) REFERENCES public.image_bytes(sha256);


--
-- Name: insertions fk_insertions_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.insertions
    ADD CONSTRAINT fk_insertions_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: leases fk_leases_case_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.leases
    ADD CONSTRAINT fk_leases_case_id FOREIGN KEY (case_id) REFERENCES public.cases(id);


--
-- Name: leases fk_leases_session_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.leases
    ADD CONSTRAINT fk_leases_session_id FOREIGN KEY (session_id) REFERENCES public.sessions(id);


--
-- Name: leases fk_leases_user_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.leases
    ADD CONSTRAINT fk_leases_user_id FOREIGN KEY (user_id) REFERENCES public.users(id);


--
-- Name: motions fk_motions_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.motions
    ADD CONSTRAINT fk_motions_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: permit_uses fk_permit_uses_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.permit_uses
    ADD CONSTRAINT fk_permit_uses_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: permit_uses fk_permit_uses_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.permit_uses
    ADD CONSTRAINT fk_permit_uses_id FOREIGN KEY (id) REFERENCES public.permits(id);


--
-- Name: permits fk_permits_approved_by; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.permits
    ADD CONSTRAINT fk_permits_approved_by FOREIGN KEY (approved_by) REFERENCES public.users(id);


--
-- Name: permits fk_permits_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.permits
    ADD CONSTRAINT fk_permits_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: planned_targets fk_planned_targets_case_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.planned_targets
    ADD CONSTRAINT fk_planned_targets_case_id FOREIGN KEY (case_id) REFERENCES public.cases(id);


--
-- Name: plans fk_plans_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.plans
    ADD CONSTRAINT fk_plans_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: registrations fk_registrations_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.registrations
    ADD CONSTRAINT fk_registrations_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: registrations fk_registrations_image_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.registrations
    ADD CONSTRAINT fk_registrations_image_id FOREIGN KEY (image_id) REFERENCES public.images(id);


--
-- Name: sessions fk_sessions_user_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.sessions
    ADD CONSTRAINT fk_sessions_user_id FOREIGN KEY (user_id) REFERENCES public.users(id);


--
-- Name: targets fk_targets_case_id_sequence; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.targets
    ADD CONSTRAINT fk_targets_case_id_sequence FOREIGN KEY (case_id, sequence) REFERENCES public.events(case_id, sequence);


--
-- Name: verdicts fk_verdicts_attempt_id; Type: FK CONSTRAINT; Schema: public; Owner: -
--

ALTER TABLE ONLY public.verdicts
    ADD CONSTRAINT fk_verdicts_attempt_id FOREIGN KEY (attempt_id) REFERENCES public.attempts(id);


--
-- PostgreSQL database dump complete
--


