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

INSERT INTO public.alembic_version VALUES ('0001');


--
-- Data for Name: attempts; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.attempts VALUES (1, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.372594Z');
INSERT INTO public.attempts VALUES (2, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.392615Z');
INSERT INTO public.attempts VALUES (3, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.413269Z');
INSERT INTO public.attempts VALUES (4, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.424993Z');
INSERT INTO public.attempts VALUES (5, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.436307Z');
INSERT INTO public.attempts VALUES (6, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.444248Z');
INSERT INTO public.attempts VALUES (7, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.452611Z');
INSERT INTO public.attempts VALUES (8, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.461549Z');
INSERT INTO public.attempts VALUES (9, 'case-1', 'b101a65ab60841ec80f8763ee0d4c269', 'case_closed', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.469785Z');
INSERT INTO public.attempts VALUES (10, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.476247Z');
INSERT INTO public.attempts VALUES (11, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.483933Z');
INSERT INTO public.attempts VALUES (12, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.494856Z');
INSERT INTO public.attempts VALUES (13, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.503001Z');
INSERT INTO public.attempts VALUES (14, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.510429Z');
INSERT INTO public.attempts VALUES (15, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.519311Z');
INSERT INTO public.attempts VALUES (16, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.526598Z');
INSERT INTO public.attempts VALUES (17, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'plan_requested', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.534702Z');
INSERT INTO public.attempts VALUES (18, 'case-2', 'b101a65ab60841ec80f8763ee0d4c269', 'case_closed', true, 'taken', '', 'case_open', '2026-11-22T09:22:48.540585Z');


--
-- Data for Name: audit_events; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.audit_events VALUES (1, 'user_added', NULL, '{"name":"anna","role":"surgeon","user_id":"b101a65ab60841ec80f8763ee0d4c269"}', '2026-11-22T09:22:48.291773Z');
INSERT INTO public.audit_events VALUES (2, 'signed_in', 'b101a65ab60841ec80f8763ee0d4c269', '{"session":"s-1"}', '2026-11-22T09:22:48.322922Z');
INSERT INTO public.audit_events VALUES (3, 'signed_out', 'b101a65ab60841ec80f8763ee0d4c269', '{"session":"s-1"}', '2026-11-22T09:22:48.546935Z');


--
-- Data for Name: cases; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.cases VALUES ('case-1', 'room-0', 'P1', '1.2', 'b101a65ab60841ec80f8763ee0d4c269', '0.1.0', '0000000000000000000000000000000000000000000000000000000000000000', '{}', '2026-11-22T09:22:48.301546Z');
INSERT INTO public.cases VALUES ('case-2', 'room-1', 'P1', '1.2', 'b101a65ab60841ec80f8763ee0d4c269', '0.1.0', '0000000000000000000000000000000000000000000000000000000000000000', '{}', '2026-11-22T09:22:48.313978Z');


--
-- Data for Name: device_files; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.device_files VALUES ('device-1', 'tcp', 'tool', '1', 'ffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffffff', NULL, '\x6e616d65203d2031', 'b101a65ab60841ec80f8763ee0d4c269', 1, '2026-01-01T00:00:00.000000Z');


--
-- Data for Name: evaluations; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.evaluations VALUES ('case-1-evaluations', 'case-1', 8, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.454466Z', '3130cebc05084d779803c20ea9d05ddd');
INSERT INTO public.evaluations VALUES ('case-2-evaluations', 'case-2', 8, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.528201Z', '3130cebc05084d779803c20ea9d05ddd');


--
-- Data for Name: events; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.events VALUES ('case-1', 1, 1, 'case_opened', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.305901Z');
INSERT INTO public.events VALUES ('case-2', 1, 1, 'case_opened', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.316797Z');
INSERT INTO public.events VALUES ('case-1', 2, 2, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.380730Z');
INSERT INTO public.events VALUES ('case-1', 3, 3, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.397672Z');
INSERT INTO public.events VALUES ('case-1', 4, 4, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.415555Z');
INSERT INTO public.events VALUES ('case-1', 5, 5, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.428150Z');
INSERT INTO public.events VALUES ('case-1', 6, 6, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.438533Z');
INSERT INTO public.events VALUES ('case-1', 7, 7, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.446890Z');
INSERT INTO public.events VALUES ('case-1', 8, 8, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.454466Z');
INSERT INTO public.events VALUES ('case-1', 9, 9, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.463447Z');
INSERT INTO public.events VALUES ('case-1', 10, 10, 'case_closed', 'b101a65ab60841ec80f8763ee0d4c269', 'closed', '{}', '{}', '2026-11-22T09:22:48.471562Z');
INSERT INTO public.events VALUES ('case-2', 2, 2, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.478453Z');
INSERT INTO public.events VALUES ('case-2', 3, 3, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.488705Z');
INSERT INTO public.events VALUES ('case-2', 4, 4, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.498023Z');
INSERT INTO public.events VALUES ('case-2', 5, 5, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.506297Z');
INSERT INTO public.events VALUES ('case-2', 6, 6, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.513927Z');
INSERT INTO public.events VALUES ('case-2', 7, 7, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.521732Z');
INSERT INTO public.events VALUES ('case-2', 8, 8, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.528201Z');
INSERT INTO public.events VALUES ('case-2', 9, 9, 'x', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{"note":"\u00b5","state":"case_open"}', '{"row":1}', '2026-11-22T09:22:48.536408Z');
INSERT INTO public.events VALUES ('case-2', 10, 10, 'note', 'b101a65ab60841ec80f8763ee0d4c269', 'case_open', '{}', '{}', '2026-11-22T09:22:48.542604Z');


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

INSERT INTO public.image_purposes VALUES ('17eaee78eb41487e8c48b334ee35274e', 'case-1', 'registration', '{"joints_rad":[0.1]}', '[]', '2026-11-22T09:22:48.339900Z');
INSERT INTO public.image_purposes VALUES ('3130cebc05084d779803c20ea9d05ddd', 'case-1', 'registration', '{"joints_rad":[0.1]}', '[]', '2026-11-22T09:22:48.353247Z');
INSERT INTO public.image_purposes VALUES ('9cc4dff60a9544c1b57f77e95a0c7790', 'case-1', 'registration', '{"joints_rad":[0.1]}', '[]', '2026-11-22T09:22:48.367757Z');


--
-- Data for Name: images; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.images VALUES ('17eaee78eb41487e8c48b334ee35274e', 1, 'cc88f6acf10ba9e488201201e9067fd63fc23aeb64fcf686578e6d900fceeef6', '1.0', '1.2', NULL, '0000000000000000000000000000000000000000000000000000000000000000', 'P1', NULL, '{"calling_ae":"CARM"}', '{"rows":96}', '2026-11-22T09:22:48.336409Z');
INSERT INTO public.images VALUES ('3130cebc05084d779803c20ea9d05ddd', 2, 'bdd295acb9859817b9da544524ed3525a64f61bf5edb16deb0c28b6ae63d378b', '1.1', '1.2', '17eaee78eb41487e8c48b334ee35274e', '1111111111111111111111111111111111111111111111111111111111111111', 'P1', NULL, '{"calling_ae":"CARM"}', '{"rows":96}', '2026-11-22T09:22:48.349949Z');
INSERT INTO public.images VALUES ('9cc4dff60a9544c1b57f77e95a0c7790', 3, '32708aa33e13cb8601678e3ffe6f522035ce3c0b8278e440299e72b1cfdcd0b9', '1.2', '1.2', '17eaee78eb41487e8c48b334ee35274e', '2222222222222222222222222222222222222222222222222222222222222222', 'P1', NULL, '{"calling_ae":"CARM"}', '{"rows":96}', '2026-11-22T09:22:48.363340Z');


--
-- Data for Name: insertions; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.insertions VALUES ('case-1-insertions', 'case-1', 9, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.463447Z');
INSERT INTO public.insertions VALUES ('case-2-insertions', 'case-2', 9, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.536408Z');


--
-- Data for Name: leases; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: lock_outs; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: motions; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.motions VALUES ('case-1-motions', 'case-1', 7, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.446890Z', '\x000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f202122232425262728292a2b2c2d2e2f303132333435363738393a3b3c3d3e3f');
INSERT INTO public.motions VALUES ('case-2-motions', 'case-2', 7, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.521732Z', '\x000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f202122232425262728292a2b2c2d2e2f303132333435363738393a3b3c3d3e3f');


--
-- Data for Name: permit_uses; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.permit_uses VALUES ('case-1-permits', 'case-1', 6, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.438533Z');
INSERT INTO public.permit_uses VALUES ('case-2-permits', 'case-2', 6, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.513927Z');


--
-- Data for Name: permits; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.permits VALUES ('case-1-permits', 'case-1', 5, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.428150Z', 'b101a65ab60841ec80f8763ee0d4c269');
INSERT INTO public.permits VALUES ('case-2-permits', 'case-2', 5, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.506297Z', 'b101a65ab60841ec80f8763ee0d4c269');


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

INSERT INTO public.plans VALUES ('case-1-plans', 'case-1', 4, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.415555Z');
INSERT INTO public.plans VALUES ('case-2-plans', 'case-2', 4, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.498023Z');


--
-- Data for Name: registrations; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.registrations VALUES ('case-1-registrations', 'case-1', 2, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.380730Z', '17eaee78eb41487e8c48b334ee35274e');
INSERT INTO public.registrations VALUES ('case-2-registrations', 'case-2', 2, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.478453Z', '17eaee78eb41487e8c48b334ee35274e');


--
-- Data for Name: room_claims; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: sessions; Type: TABLE DATA; Schema: public; Owner: -
--



--
-- Data for Name: targets; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.targets VALUES ('case-1-targets', 'case-1', 3, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.397672Z');
INSERT INTO public.targets VALUES ('case-2-targets', 'case-2', 3, '[]', '{"value":0.1234567}', '2026-11-22T09:22:48.488705Z');


--
-- Data for Name: users; Type: TABLE DATA; Schema: public; Owner: -
--

INSERT INTO public.users VALUES ('b101a65ab60841ec80f8763ee0d4c269', 'anna', 'surgeon', '$argon2id$v=19$m=8,t=1,p=1$sIFXziJGFA/bqHPRqisEXQ$54cIbBTpkoQM+22eOaoRClmzJKkTLxiKcd/WMXHAsqc', '$argon2id$v=19$m=8,t=1,p=1$/0zVtR01mK78EDh3RSABXQ$KhE7mtzfxae0R7LCRMBeGt9XVegVIi/FL01BZXZdqjU', '2026-11-22T09:22:48.288422Z', NULL);


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

SELECT pg_catalog.setval('public.attempts_id_seq', 1, false);


--
-- Name: audit_events_id_seq; Type: SEQUENCE SET; Schema: public; Owner: -
--

SELECT pg_catalog.setval('public.audit_events_id_seq', 1, false);


--
-- Name: verdicts_id_seq; Type: SEQUENCE SET; Schema: public; Owner: -
--

SELECT pg_catalog.setval('public.verdicts_id_seq', 1, false);


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
-- Name: ix_verdicts_attempt_id; Type: INDEX; Schema: public; Owner: -
--

CREATE INDEX ix_verdicts_attempt_id ON public.verdicts USING btree (attempt_id);


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


